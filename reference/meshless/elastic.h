/* elastic.h - how a meshless body comes about: the field of a mesh's points, octants, matrices and
 * modes. elastic_absent.c is this where the libraries that find modes are not, in the page: bodies
 * are stored there (stored.h). */
#ifndef REF_ELASTIC_H
#define REF_ELASTIC_H

#include "engine.h"

/* Fills body and seconds: octants, nodes, covers and matrices of the options' field,
 * whose covers reach `count` points. Where *x is NULL these are the field's own, which it then
 * receives, the caller's to free. The field of a body that may be cut is kept. Errors: those of
 * ref_meshless_field() and ref_body_build(). */
SmCode ref_elastic_body(const RefMeshlessOptions *options, bool cuttable, long *count,
                        double (**x)[3], RefElastic *elastic, SmError *error);

/* Fills in the modes of the free body, as many as the options say. Errors: ref_modes_find()'s. */
SmCode ref_elastic_modes(const RefMeshlessOptions *options, RefElastic *elastic, SmError *error);

#endif
