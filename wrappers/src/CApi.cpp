/*
 * Forces of membranes for C.
 */

#include "CApiSupport.h"
#include "ForceFactory.h"

#include <algorithm>
#include <cmath>
#include <memory>

using namespace HelfrichPlugin;
using OpenMM::OpenMMException;
using std::string;
using std::vector;

namespace {

MembraneForce& asForce(void* force) {
    return as<MembraneForce>("MembraneForce", force);
}

/** A membrane force or a mover. */
TriangulatedForce& asTriangulated(void* force) {
    return as<TriangulatedForce>("MembraneForce", force);
}

} // namespace

extern "C" {

OpenMM_Force* helfrich_shim_createForce(const char* type, const int* triangles, int numTriangles, const double* values,
                                        int numValues, int form) {
    return made([&] {
        std::unique_ptr<MembraneForce> force(makeForce(type));
        HelfrichParameterInfo next;
        bool lacksOne =
            Helfrich_Potential_parameter(type, numValues, &next) == Helfrich_Success && std::isnan(next.defaultValue);
        if (lacksOne || numValues > force->getNumParameters())
            throw OpenMMException(string(type) + ": needs " + std::to_string(force->getNumParameters()) + " scalars");
        for (int i = 0; i < numValues; i++)
            force->setParameterValue(force->getParameterName(i), values[i]);
        if (form != 0)
            force->setForm(form);
        force->addTriangles(cornersOf(type, triangles, numTriangles));
        return force.release();
    });
}

void helfrich_shim_MembraneForce_destroy(OpenMM_Force* force) {
    delete reinterpret_cast<OpenMM::Force*>(force);
}

int helfrich_shim_MembraneForce_addTriangle(OpenMM_Force* force, int particle1, int particle2, int particle3) {
    return valueOr<int>(-1, [&] { return asTriangulated(force).addTriangle(particle1, particle2, particle3); });
}

int helfrich_shim_MembraneForce_getNumTriangles(OpenMM_Force* force) {
    return valueOr<int>(-1, [&] { return asTriangulated(force).getNumTriangles(); });
}

Helfrich_Status helfrich_shim_MembraneForce_getTriangle(OpenMM_Force* force, int index, int* corners) {
    return guarded([&] { asTriangulated(force).getTriangle(index, corners[0], corners[1], corners[2]); });
}

Helfrich_Status helfrich_shim_MembraneForce_getParameterValue(OpenMM_Force* force, const char* parameter,
                                                              double* value) {
    return guarded([&] { *value = asForce(force).getParameterValue(parameter); });
}

Helfrich_Status helfrich_shim_MembraneForce_setParameterValue(OpenMM_Force* force, const char* parameter,
                                                              double value) {
    return guarded([&] { asForce(force).setParameterValue(parameter, value); });
}

Helfrich_Status helfrich_shim_MembraneForce_setElementValues(OpenMM_Force* force, const char* parameter,
                                                             const double* values, int count) {
    return guarded([&] { asForce(force).setElementValues(parameter, vector<double>(values, values + count)); });
}

int helfrich_shim_MembraneForce_getNumElementValues(OpenMM_Force* force, const char* parameter) {
    return valueOr<int>(-1, [&] { return (int) asForce(force).getElementValues(parameter).size(); });
}

Helfrich_Status helfrich_shim_MembraneForce_getElementValues(OpenMM_Force* force, const char* parameter,
                                                             double* values) {
    return guarded([&] {
        const vector<double>& found = asForce(force).getElementValues(parameter);
        std::copy(found.begin(), found.end(), values);
    });
}

Helfrich_Status helfrich_shim_ParticleSurfaceForce_setParticles(OpenMM_Force* force, const int* particles, int count) {
    return guarded([&] {
        auto& owner = as<ParticleSurfaceForce>("ParticleSurfaceForce", force);
        if (count < 0)
            throw OpenMMException(owner.getTypeName() + ": the number of particles is negative");
        owner.setParticles(vector<int>(particles, particles + count));
    });
}

Helfrich_Status helfrich_shim_MembraneForce_setReference(OpenMM_Force* force, const double* positions, int numVertices,
                                                         const double* boxVectors) {
    return guarded([&] {
        MembraneForce& owner = asForce(force);
        if (numVertices < 0)
            throw OpenMMException(owner.getTypeName() + ": the number of vertices is negative");
        owner.setReferenceBox(boxVectors == nullptr ? vector<double>() : vector<double>(boxVectors, boxVectors + 9));
        owner.setVertexNumbers(vector<double>(positions, positions + 3 * (size_t) numVertices));
    });
}

Helfrich_Status helfrich_shim_LineTensionForce_setDomains(OpenMM_Force* force, const int* domains, int numVertices) {
    return guarded([&] {
        auto& owner = as<LineTensionForce>("LineTensionForce", force);
        if (numVertices < 0)
            throw OpenMMException(owner.getTypeName() + ": the number of vertices is negative");
        owner.setDomains(vector<int>(domains, domains + numVertices));
    });
}

Helfrich_Status helfrich_shim_MembraneForce_setForm(OpenMM_Force* force, int form) {
    return guarded([&] { asForce(force).setForm(form); });
}

int helfrich_shim_MembraneForce_getForm(OpenMM_Force* force) {
    return valueOr<int>(-1, [&] { return asForce(force).getForm(); });
}

int helfrich_shim_MembraneForce_getSwitch(OpenMM_Force* force, const char* name) {
    return valueOr<int>(-1, [&] { return asForce(force).getSwitch(name); });
}

Helfrich_Status helfrich_shim_MembraneForce_setSwitch(OpenMM_Force* force, const char* name, int on) {
    return guarded([&] { asForce(force).setSwitch(name, on != 0); });
}

Helfrich_Status helfrich_shim_MembraneForce_setBackend(OpenMM_Force* force, const char* backend) {
    return guarded([&] { asForce(force).setBackend(backend); });
}

Helfrich_Status helfrich_shim_MembraneForce_setUsesPeriodicBoundaryConditions(OpenMM_Force* force, int periodic) {
    return guarded([&] { asForce(force).setUsesPeriodicBoundaryConditions(periodic != 0); });
}

int helfrich_shim_MembraneForce_usesPeriodicBoundaryConditions(OpenMM_Force* force) {
    return valueOr<int>(-1, [&] { return asForce(force).usesPeriodicBoundaryConditions(); });
}

Helfrich_Status helfrich_shim_MembraneForce_setContextParameter(OpenMM_Force* force, const char* parameter,
                                                                const char* name) {
    return guarded([&] { asForce(force).setContextParameter(parameter, name); });
}

Helfrich_Status helfrich_shim_MembraneForce_addEnergyParameterDerivative(OpenMM_Force* force, const char* name) {
    return guarded([&] { asForce(force).addEnergyParameterDerivative(name); });
}

Helfrich_Status helfrich_shim_MembraneForce_updateParametersInContext(OpenMM_Force* force, OpenMM_Context* context) {
    return guarded([&] { asForce(force).updateParametersInContext(asContext(context)); });
}
Helfrich_Status helfrich_shim_MembraneForce_getTrianglesInContext(OpenMM_Force* force, OpenMM_Context* context,
                                                                  int* corners) {
    return guarded([&] {
        vector<int> found = asTriangulated(force).getTrianglesInContext(asContext(context));
        std::copy(found.begin(), found.end(), corners);
    });
}

Helfrich_Status helfrich_shim_MembraneForce_getVirial(OpenMM_Force* force, OpenMM_Context* context, int groups,
                                                      double* virial) {
    return guarded([&] {
        vector<double> found = asTriangulated(force).getVirial(asContext(context), groups);
        std::copy(found.begin(), found.end(), virial);
    });
}

Helfrich_Status helfrich_shim_MembraneForce_setTrianglesInContext(OpenMM_Force* force, OpenMM_Context* context,
                                                                  const int* corners, int numTriangles) {
    return guarded([&] {
        TriangulatedForce& surface = asTriangulated(force);
        surface.setTrianglesInContext(asContext(context), cornersOf(surface.getTypeName(), corners, numTriangles));
    });
}

Helfrich_Status helfrich_shim_MembraneForce_getPermutationInContext(OpenMM_Force* force, OpenMM_Context* context,
                                                                    int* permutation) {
    return guarded([&] {
        vector<int> found = asTriangulated(force).getPermutationInContext(asContext(context));
        std::copy(found.begin(), found.end(), permutation);
    });
}

Helfrich_Status helfrich_shim_MembraneForce_setPermutationInContext(OpenMM_Force* force, OpenMM_Context* context,
                                                                    const int* permutation, int numVertices) {
    return guarded([&] {
        TriangulatedForce& surface = asTriangulated(force);
        if (numVertices < 0)
            throw OpenMMException(surface.getTypeName() + ": the number of vertices is negative");
        surface.setPermutationInContext(asContext(context), vector<int>(permutation, permutation + numVertices));
    });
}

int64_t helfrich_shim_MembraneForce_saveConnectivity(OpenMM_Force* force, OpenMM_Context* context, char* buffer,
                                                     int64_t size) {
    return valueOr<int64_t>(-1, [&] {
        string saved = asTriangulated(force).saveConnectivity(asContext(context));
        if ((int64_t) saved.size() <= size)
            std::copy(saved.begin(), saved.end(), buffer);
        return (int64_t) saved.size();
    });
}

Helfrich_Status helfrich_shim_MembraneForce_restoreConnectivity(OpenMM_Force* force, OpenMM_Context* context,
                                                                const char* saved, int64_t size) {
    return guarded([&] {
        TriangulatedForce& surface = asTriangulated(force);
        if (size < 0)
            throw OpenMMException(surface.getTypeName() + ": the number of bytes is negative");
        surface.restoreConnectivity(asContext(context), string(saved, (size_t) size));
    });
}

Helfrich_Status helfrich_shim_LineTensionForce_getDomainsInContext(OpenMM_Force* force, OpenMM_Context* context,
                                                                   int* domains) {
    return guarded([&] {
        auto& owner = as<LineTensionForce>("LineTensionForce", force);
        vector<int> found = owner.getDomainsInContext(asContext(context));
        std::copy(found.begin(), found.end(), domains);
    });
}
}
