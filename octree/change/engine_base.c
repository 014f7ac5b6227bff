#include "engine_base.h"

SmCode oct_engine_may_change(SmEngine *engine, SmError *error)
{
    return ((OctEngineBase *)engine)->may(engine, error);
}

SmCode oct_engine_begin(SmEngine *engine, OctStructure **structure, SmError *error)
{
    OctEngineBase *base = (OctEngineBase *)engine;
    *structure = &base->structure;
    return base->begin(engine, error);
}

const OctChange *oct_engine_end(SmEngine *engine)
{
    return ((OctEngineBase *)engine)->end(engine);
}

const int *oct_engine_leaves(SmEngine *engine)
{
    return ((OctEngineBase *)engine)->leaves(engine);
}

const OctStructure *oct_engine_structure(const SmEngine *engine)
{
    return &((const OctEngineBase *)engine)->structure;
}
