/* bullet.cpp - a body of Bullet's (libbullet-dev), stepped and timed in a process of its own, for
 * scripts/baselines.py.
 *
 * Standard input, words apart by blanks:
 *     METHOD STIFFNESS H GX GY GZ TIMED SETTLE_H SETTLED
 *     NODES, then for each x y z mass        mass 0: it is held
 *     TETRAHEDRA, then for each a b c d
 * METHOD "elements": corotated linear elements with implicit steps
 * (btDeformableMultiBodyDynamicsWorld), STIFFNESS their Young's modulus. "clusters": shape matching
 * of clusters (Mueller et al. 2005) beside springs along the edges (btSoftRigidDynamicsWorld);
 * STIFFNESS up to 1 is that of springs, above 1 how often they are solved in a step.
 *
 * Output: a line "seconds" with the time of each of TIMED steps of H from rest. Then SETTLED steps
 * of SETTLE_H, each of which takes away 3% of all velocities; a line "speed" with the largest that
 * is left, and a line "positions" with three numbers a node. Exit code 3: the input cannot be read.
 */
#include <btBulletDynamicsCommon.h>

#include <BulletSoftBody/btDeformableBodySolver.h>
#include <BulletSoftBody/btDeformableMultiBodyConstraintSolver.h>
#include <BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <set>
#include <string>
#include <vector>

namespace
{
struct Input {
    std::string method;
    double stiffness = 0, h = 0, settle_h = 0;
    btVector3 gravity;
    int timed = 0, settled = 0;
    std::vector<btVector3> position;
    std::vector<btScalar> mass;
    std::vector<std::vector<int>> tetrahedra;
};

bool read(std::istream &in, Input &input)
{
    double g[3];
    size_t nodes = 0, tetrahedra = 0;
    in >> input.method >> input.stiffness >> input.h >> g[0] >> g[1] >> g[2];
    in >> input.timed >> input.settle_h >> input.settled >> nodes;
    input.gravity = btVector3(btScalar(g[0]), btScalar(g[1]), btScalar(g[2]));
    for (size_t n = 0; in && n < nodes; n++) {
        double x, y, z, mass;
        in >> x >> y >> z >> mass;
        input.position.emplace_back(btScalar(x), btScalar(y), btScalar(z));
        input.mass.push_back(btScalar(mass));
    }
    in >> tetrahedra;
    for (size_t t = 0; in && t < tetrahedra; t++) {
        std::vector<int> corner(4);
        for (int &c : corner) {
            in >> c;
            if (c < 0 || size_t(c) >= nodes) return false;
        }
        input.tetrahedra.push_back(corner);
    }
    return in && nodes > 0 && tetrahedra > 0 && input.h > 0 && input.timed > 0 &&
           (input.method == "elements" || input.method == "clusters");
}

/* What both worlds have, in the order in which it is taken apart. */
struct World {
    btSoftBodyRigidBodyCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher{&configuration};
    btDbvtBroadphase broadphase;
    std::unique_ptr<btDeformableBodySolver> deformable;
    std::unique_ptr<btDeformableMultiBodyConstraintSolver> deformable_solver;
    btSequentialImpulseConstraintSolver solver;
    std::unique_ptr<btDiscreteDynamicsWorld> world;
    std::vector<std::unique_ptr<btDeformableLagrangianForce>> forces;
    std::unique_ptr<btSoftBody> body;
    ~World()
    {
        if (auto *soft = dynamic_cast<btSoftRigidDynamicsWorld *>(world.get()))
            soft->removeSoftBody(body.get());
        if (auto *soft = dynamic_cast<btDeformableMultiBodyDynamicsWorld *>(world.get()))
            soft->removeSoftBody(body.get());
    }
};

void make_body(const Input &input, btSoftBodyWorldInfo &info, World &all)
{
    info.m_gravity = input.gravity;
    info.air_density = info.water_density = 0;
    all.body.reset(new btSoftBody(&info, int(input.position.size()), input.position.data(),
                                  input.mass.data()));
    for (size_t n = 0; n < input.mass.size(); n++) all.body->setMass(int(n), input.mass[n]);
    std::set<std::pair<int, int>> edges;
    for (const auto &t : input.tetrahedra) {
        all.body->appendTetra(t[0], t[1], t[2], t[3]);
        for (int a = 0; a < 4; a++)
            for (int b = a + 1; b < 4; b++) edges.insert(std::minmax(t[a], t[b]));
    }
    for (const auto &edge : edges) all.body->appendLink(edge.first, edge.second);
    all.body->m_cfg.collisions = 0;
    all.body->setActivationState(DISABLE_DEACTIVATION);
    all.body->m_sleepingThreshold = 0;
}

void make_elements(const Input &input, World &all)
{
    all.deformable.reset(new btDeformableBodySolver);
    all.deformable_solver.reset(new btDeformableMultiBodyConstraintSolver);
    all.deformable_solver->setDeformableSolver(all.deformable.get());
    auto *world = new btDeformableMultiBodyDynamicsWorld(&all.dispatcher, &all.broadphase,
                                                         all.deformable_solver.get(),
                                                         &all.configuration, all.deformable.get());
    all.world.reset(world);
    world->setGravity(input.gravity);
    make_body(input, world->getWorldInfo(), all);
    btSoftBodyHelpers::generateBoundaryFaces(all.body.get());
    all.body->initializeDmInverse();
    all.body->m_tetraScratches.resize(all.body->m_tetras.size());
    all.body->m_tetraScratchesTn.resize(all.body->m_tetras.size());
    world->addSoftBody(all.body.get());
    auto *elastic = new btDeformableLinearElasticityForce(1, 1, 0, 0);
    elastic->setPoissonRatio(btScalar(0.3));
    elastic->setYoungsModulus(btScalar(input.stiffness));
    all.forces.emplace_back(elastic);
    all.forces.emplace_back(new btDeformableGravityForce(input.gravity));
    for (auto &force : all.forces) world->addForce(all.body.get(), force.get());
    world->setImplicit(true);
    world->setLineSearch(false);
    world->setUseProjection(true); /* without it nothing moves in 3.24 where nothing touches */
}

void make_clusters(const Input &input, World &all)
{
    auto *world = new btSoftRigidDynamicsWorld(&all.dispatcher, &all.broadphase, &all.solver,
                                               &all.configuration);
    all.world.reset(world);
    world->setGravity(input.gravity);
    make_body(input, world->getWorldInfo(), all);
    all.body->m_materials[0]->m_kLST = btScalar(std::fmin(input.stiffness, 1.0));
    all.body->updateConstants();
    all.body->m_cfg.piterations = int(std::fmax(std::round(input.stiffness), 1.0));
    /* About as many nodes each as a region of w = 1 has. */
    all.body->generateClusters(int(std::fmax(2.0, double(input.position.size()) / 27)));
    for (int c = 0; c < all.body->m_clusters.size(); c++) all.body->m_clusters[c]->m_matching = 1;
    world->addSoftBody(all.body.get());
}

double step(World &all, double h)
{
    auto start = std::chrono::steady_clock::now();
    all.world->stepSimulation(btScalar(h), 1, btScalar(h));
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void simulate(const Input &input, World &all)
{
    double speed = 0;
    std::printf("seconds");
    for (int s = 0; s < input.timed; s++) std::printf(" %.9g", step(all, input.h));
    for (int s = 0; s < input.settled; s++) {
        step(all, input.settle_h);
        for (int n = 0; n < all.body->m_nodes.size(); n++)
            all.body->m_nodes[n].m_v *= btScalar(0.97);
    }
    for (int n = 0; n < all.body->m_nodes.size(); n++)
        speed = std::fmax(speed, double(all.body->m_nodes[n].m_v.length()));
    std::printf("\nspeed %.9g\npositions", speed);
    for (int n = 0; n < all.body->m_nodes.size(); n++) {
        const btVector3 &x = all.body->m_nodes[n].m_x;
        std::printf(" %.9g %.9g %.9g", double(x.x()), double(x.y()), double(x.z()));
    }
    std::printf("\n");
}
} // namespace

int main()
{
    Input input;
    if (!read(std::cin, input)) {
        std::fprintf(stderr, "bullet: the body on standard input cannot be read\n");
        return 3;
    }
    World all;
    if (input.method == "elements")
        make_elements(input, all);
    else
        make_clusters(input, all);
    simulate(input, all);
    return 0;
}
