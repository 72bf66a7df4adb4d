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
        std::unique_ptr<MembraneForce> force(makeForce(nameOf("MembraneForce", type)));
        int known = force->getNumParameters();
        vector<double> all = arrayOf(type, "scalars", values, numValues);
        while ((int) all.size() < known) {
            HelfrichParameterInfo next;
            check(Helfrich_Potential_parameter(type, (int) all.size(), &next));
            all.push_back(next.defaultValue);
        }
        if (numValues > known ||
            std::any_of(all.begin() + numValues, all.end(), [](double x) { return std::isnan(x); }))
            throw OpenMMException(string(type) + ": needs " + std::to_string(known) + " scalars, got " +
                                  std::to_string(numValues) + "; only the last ones may be left out, if they have a " +
                                  "default");
        for (int i = 0; i < known; i++)
            force->setParameterValue(force->getParameterName(i), all[i]);
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
    return guarded([&] { *value = asForce(force).getParameterValue(nameOf("MembraneForce", parameter)); });
}

Helfrich_Status helfrich_shim_MembraneForce_setParameterValue(OpenMM_Force* force, const char* parameter,
                                                              double value) {
    return guarded([&] { asForce(force).setParameterValue(nameOf("MembraneForce", parameter), value); });
}

Helfrich_Status helfrich_shim_MembraneForce_setElementValues(OpenMM_Force* force, const char* parameter,
                                                             const double* values, int count) {
    return guarded([&] {
        MembraneForce& owner = asForce(force);
        string type = owner.getTypeName();
        owner.setElementValues(nameOf(type, parameter), arrayOf(type, "values", values, count));
    });
}

int helfrich_shim_MembraneForce_getNumElementValues(OpenMM_Force* force, const char* parameter) {
    return valueOr<int>(
        -1, [&] { return (int) asForce(force).getElementValues(nameOf("MembraneForce", parameter)).size(); });
}

Helfrich_Status helfrich_shim_MembraneForce_getElementValues(OpenMM_Force* force, const char* parameter,
                                                             double* values) {
    return guarded([&] {
        const vector<double>& found = asForce(force).getElementValues(nameOf("MembraneForce", parameter));
        std::copy(found.begin(), found.end(), values);
    });
}

Helfrich_Status helfrich_shim_ParticleSurfaceForce_setParticles(OpenMM_Force* force, const int* particles, int count) {
    return guarded([&] {
        auto& owner = as<ParticleSurfaceForce>("ParticleSurfaceForce", force);
        owner.setParticles(arrayOf(owner.getTypeName(), "particles", particles, count));
    });
}

Helfrich_Status helfrich_shim_MembraneForce_setReference(OpenMM_Force* force, const double* positions, int numVertices,
                                                         const double* boxVectors) {
    return guarded([&] {
        MembraneForce& owner = asForce(force);
        vector<double> points = arrayOf(owner.getTypeName(), "vertices", positions, numVertices, 3);
        vector<double> before = owner.getReferenceBox();
        owner.setReferenceBox(boxVectors == nullptr ? vector<double>() : vector<double>(boxVectors, boxVectors + 9));
        try {
            owner.setVertexNumbers(points);
        } catch (...) {
            owner.setReferenceBox(before);
            throw;
        }
    });
}

Helfrich_Status helfrich_shim_LineTensionForce_setDomains(OpenMM_Force* force, const int* domains, int numVertices) {
    return guarded([&] {
        auto& owner = as<LineTensionForce>("LineTensionForce", force);
        owner.setDomains(arrayOf(owner.getTypeName(), "vertices", domains, numVertices));
    });
}

Helfrich_Status helfrich_shim_MembraneForce_setForm(OpenMM_Force* force, int form) {
    return guarded([&] { asForce(force).setForm(form); });
}

int helfrich_shim_MembraneForce_getForm(OpenMM_Force* force) {
    return valueOr<int>(-1, [&] { return asForce(force).getForm(); });
}

int helfrich_shim_MembraneForce_getSwitch(OpenMM_Force* force, const char* name) {
    return valueOr<int>(-1, [&] { return asForce(force).getSwitch(nameOf("MembraneForce", name)); });
}

Helfrich_Status helfrich_shim_MembraneForce_setSwitch(OpenMM_Force* force, const char* name, int on) {
    return guarded([&] { asForce(force).setSwitch(nameOf("MembraneForce", name), on != 0); });
}

Helfrich_Status helfrich_shim_MembraneForce_setBackend(OpenMM_Force* force, const char* backend) {
    return guarded([&] { asForce(force).setBackend(nameOf("MembraneForce", backend)); });
}

Helfrich_Status helfrich_shim_MembraneForce_setUsesPeriodicBoundaryConditions(OpenMM_Force* force, int periodic) {
    return guarded([&] { asForce(force).setUsesPeriodicBoundaryConditions(periodic != 0); });
}

int helfrich_shim_MembraneForce_usesPeriodicBoundaryConditions(OpenMM_Force* force) {
    return valueOr<int>(-1, [&] { return asForce(force).usesPeriodicBoundaryConditions(); });
}

Helfrich_Status helfrich_shim_MembraneForce_setContextParameter(OpenMM_Force* force, const char* parameter,
                                                                const char* name) {
    return guarded(
        [&] { asForce(force).setContextParameter(nameOf("MembraneForce", parameter), nameOf("MembraneForce", name)); });
}

Helfrich_Status helfrich_shim_MembraneForce_addEnergyParameterDerivative(OpenMM_Force* force, const char* name) {
    return guarded([&] { asForce(force).addEnergyParameterDerivative(nameOf("MembraneForce", name)); });
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
        surface.setPermutationInContext(asContext(context),
                                        arrayOf(surface.getTypeName(), "vertices", permutation, numVertices));
    });
}

int64_t helfrich_shim_MembraneForce_saveConnectivity(OpenMM_Force* force, OpenMM_Context* context, char* buffer,
                                                     int64_t size) {
    return valueOr<int64_t>(
        -1, [&] { return copied(asTriangulated(force).saveConnectivity(asContext(context)), buffer, size); });
}

Helfrich_Status helfrich_shim_MembraneForce_restoreConnectivity(OpenMM_Force* force, OpenMM_Context* context,
                                                                const char* saved, int64_t size) {
    return guarded([&] {
        TriangulatedForce& surface = asTriangulated(force);
        surface.restoreConnectivity(asContext(context), bytesOf(surface.getTypeName(), saved, size));
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
