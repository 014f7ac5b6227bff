#include "head.h"

SmCode oct_engine_begin(SmEngine *engine, OctStructure **structure, SmError *error)
{
    OctHead *head = (OctHead *)engine;
    *structure = &head->structure;
    return head->begin(engine, error);
}

const OctChange *oct_engine_end(SmEngine *engine)
{
    return ((OctHead *)engine)->end(engine);
}

const int *oct_engine_leaves(SmEngine *engine)
{
    return ((OctHead *)engine)->leaves(engine);
}

SmCode oct_engine_rebuild(SmEngine *engine, const SmEngineParams *params, SmEngine **copy,
                          long *order, SmError *error)
{
    return ((OctHead *)engine)->rebuild(engine, params, copy, order, error);
}
