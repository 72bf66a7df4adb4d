#include "ForceFactory.h"

#include <openmm/Context.h>

#include <exception>
#include <memory>

using namespace HelfrichPlugin;
using OpenMM::OpenMMException;
using std::string;
using std::vector;

namespace {

MembraneForce& asForce(void* force) {
    // C hands over the address of an OpenMM::Force.
    OpenMM::Force* any = static_cast<OpenMM::Force*>(force);
    auto* found = dynamic_cast<MembraneForce*>(any);
    if (found == nullptr)
        throw OpenMMException("MembraneForce: the force \"" + any->getName() + "\" is of another class");
    return *found;
}

/** Run something that may throw; C gets a status and a message. */
template <class Body>
int guarded(Body body) {
    try {
        body();
        return 0;
    } catch (const std::exception& error) {
        helfrich_setLastError(error.what());
    } catch (...) {
        helfrich_setLastError("openmm-helfrich: an unknown exception");
    }
    return 1;
}

} // namespace

// What the C functions of the Rust core (src/c_api.rs) do with force objects.
extern "C" {

void* helfrich_shim_createForce(const char* type, const int* triangles, int numTriangles, const double* values,
                                int numValues, int form) {
    OpenMM::Force* created = nullptr;
    guarded([&] {
        std::unique_ptr<MembraneForce> force(makeForce(type));
        if (numValues != force->getNumParameters())
            throw OpenMMException(string(type) + ": needs " + std::to_string(force->getNumParameters()) + " scalars");
        for (int i = 0; i < numValues; i++)
            force->setParameterValue(force->getParameterName(i), values[i]);
        if (form != 0)
            force->setForm(form);
        if (numTriangles < 0)
            throw OpenMMException(string(type) + ": the number of triangles is negative");
        force->addTriangles(vector<int>(triangles, triangles + 3 * (size_t) numTriangles));
        created = force.release();
    });
    return created;
}

void helfrich_shim_destroyForce(void* force) {
    delete static_cast<OpenMM::Force*>(force);
}

int helfrich_shim_addTriangle(void* force, int particle1, int particle2, int particle3) {
    int index = -1;
    guarded([&] { index = asForce(force).addTriangle(particle1, particle2, particle3); });
    return index;
}

int helfrich_shim_getNumTriangles(void* force) {
    int count = -1;
    guarded([&] { count = asForce(force).getNumTriangles(); });
    return count;
}

int helfrich_shim_getTriangle(void* force, int index, int* corners) {
    return guarded([&] { asForce(force).getTriangle(index, corners[0], corners[1], corners[2]); });
}

int helfrich_shim_getValue(void* force, const char* parameter, double* value) {
    return guarded([&] { *value = asForce(force).getParameterValue(parameter); });
}

int helfrich_shim_setValue(void* force, const char* parameter, double value) {
    return guarded([&] { asForce(force).setParameterValue(parameter, value); });
}

int helfrich_shim_setElementValues(void* force, const char* parameter, const double* values, int count) {
    return guarded([&] { asForce(force).setElementValues(parameter, vector<double>(values, values + count)); });
}

int helfrich_shim_setForm(void* force, int form) {
    return guarded([&] { asForce(force).setForm(form); });
}

int helfrich_shim_setSwitch(void* force, const char* name, int on) {
    return guarded([&] { asForce(force).setSwitch(name, on != 0); });
}

int helfrich_shim_setBackend(void* force, const char* backend) {
    return guarded([&] { asForce(force).setBackend(backend); });
}

int helfrich_shim_setContextParameter(void* force, const char* parameter, const char* name) {
    return guarded([&] { asForce(force).setContextParameter(parameter, name); });
}

int helfrich_shim_addEnergyParameterDerivative(void* force, const char* name) {
    return guarded([&] { asForce(force).addEnergyParameterDerivative(name); });
}

int helfrich_shim_updateParametersInContext(void* force, void* context) {
    return guarded([&] { asForce(force).updateParametersInContext(*static_cast<OpenMM::Context*>(context)); });
}
}
