%module(package="openmmhelfrich") forces

%{
#include "OpenMMHelfrich.h"
#include <OpenMM.h>
#include <OpenMMAmoeba.h>
#include <OpenMMDrude.h>
#include <openmm/RPMDIntegrator.h>
#include <openmm/RPMDMonteCarloBarostat.h>
using namespace HelfrichPlugin;
%}

%include <std_string.i>
%include <std_vector.i>
%include <exception.i>
%import(module="openmm") "swig/OpenMMSwigHeaders.i"

/* Errors of the core arrive as openmm.OpenMMException, like OpenMM's own. */
%exception {
    try {
        $action
    } catch (const OpenMM::OpenMMException& error) {
        PyObject* module = PyImport_ImportModule("openmm");
        PyObject* type = module == NULL ? NULL : PyObject_GetAttrString(module, "OpenMMException");
        if (type != NULL)
            PyErr_SetString(type, error.what());
        Py_XDECREF(type);
        Py_XDECREF(module);
        SWIG_fail;
    } catch (const std::exception& error) {
        SWIG_exception(SWIG_RuntimeError, error.what());
    }
}

%apply int& OUTPUT { int& particle1, int& particle2, int& particle3 };
/* SWIG takes Python's own int only; NumPy's have an index, too. */
%typemap(in) int {
    PyObject* number = PyNumber_Index($input);
    if (number == NULL) {
        if (PyErr_ExceptionMatches(PyExc_TypeError))
            PyErr_SetString(PyExc_TypeError, "in method '$symname', argument $argnum must be an integer");
        SWIG_fail;
    }
    long value = PyLong_AsLong(number);
    Py_DECREF(number);
    if (PyErr_Occurred() != NULL || value != (long) (int) value) {
        PyErr_SetString(PyExc_OverflowError, "in method '$symname', argument $argnum must be of 32 bits");
        SWIG_fail;
    }
    $1 = (int) value;
}
/* Not SWIG's pybuffer.i: before Python 3.11 the stable ABI has no buffers. */
%typemap(in) (const char* data, size_t size) (char* bytes, Py_ssize_t length) {
    if (PyBytes_AsStringAndSize($input, &bytes, &length) != 0)
        SWIG_fail;
    $1 = bytes;
    $2 = static_cast<size_t>(length);
}

/* Arrays come as one buffer, through _surfaces.py. .ci/forces.py leaves out what is ignored here. */
%ignore HelfrichPlugin::TriangulatedForce::addTriangles;
%ignore HelfrichPlugin::TriangulatedForce::getTriangles;
%ignore HelfrichPlugin::TriangulatedForce::getTrianglesInContext;
%ignore HelfrichPlugin::TriangulatedForce::setTrianglesInContext;
%ignore HelfrichPlugin::TriangulatedForce::getVirial;
%ignore HelfrichPlugin::TriangulatedForce::saveConnectivity;
%ignore HelfrichPlugin::TriangulatedForce::restoreConnectivity;
%ignore HelfrichPlugin::TriangulatedForce::getPermutationInContext;
%ignore HelfrichPlugin::TriangulatedForce::setPermutationInContext;
%ignore HelfrichPlugin::MonteCarloSurfaceMover::getStatistics;
%ignore HelfrichPlugin::MonteCarloMembraneTension::getStatistics;
%ignore HelfrichPlugin::MonteCarloMembraneTension::saveState;
%ignore HelfrichPlugin::MonteCarloMembraneTension::restoreState;
%ignore HelfrichPlugin::SurfaceViscosityThermostat::saveState;
%ignore HelfrichPlugin::SurfaceViscosityThermostat::restoreState;
%ignore HelfrichPlugin::MembraneForce::getParticles;
%ignore HelfrichPlugin::MembraneForce::getVertexNumbers;
%ignore HelfrichPlugin::MembraneForce::setVertexNumbers;
%ignore HelfrichPlugin::MembraneForce::getReferenceBox;
%ignore HelfrichPlugin::MembraneForce::setReferenceBox;
%ignore *::getReference;
%ignore *::setReference;
%ignore *::getDomains;
%ignore *::setDomains;
%ignore *::getDomainsInContext;
%ignore HelfrichPlugin::ParticleSurfaceForce::setParticles;
%ignore HelfrichPlugin::MembraneForce::setParameterValue;
%ignore HelfrichPlugin::VariableMassIntegrator::getMasses;
%rename(_setElementValues) HelfrichPlugin::MembraneForce::setElementValues;
%rename(_HelfrichForce) HelfrichPlugin::HelfrichForce;
%rename(_SurfaceMover) HelfrichPlugin::MonteCarloSurfaceMover;
%nodefaultctor HelfrichPlugin::HelfrichForce;
%nodefaultctor HelfrichPlugin::MonteCarloMover;
%nodefaultctor HelfrichPlugin::MonteCarloSurfaceMover;
%nodefaultctor HelfrichPlugin::TriangulatedForce;
%nodefaultctor HelfrichPlugin::MembraneForce;
%nodefaultctor HelfrichPlugin::VariableMassIntegrator;

%{
static PyObject* toBytes(const void* data, size_t size) {
    return PyBytes_FromStringAndSize(static_cast<const char*>(data), (Py_ssize_t) size);
}
%}

%extend HelfrichPlugin::TriangulatedForce {
    void _addTriangleBuffer(const char* data, size_t size) {
        const int* corners = reinterpret_cast<const int*>(data);
        $self->addTriangles(std::vector<int>(corners, corners + size / sizeof(int)));
    }
    PyObject* _triangleBuffer() {
        const std::vector<int>& corners = $self->getTriangles();
        return toBytes(corners.data(), corners.size() * sizeof(int));
    }
    PyObject* _getTrianglesInContext(OpenMM::Context& context) {
        std::vector<int> corners = $self->getTrianglesInContext(context);
        return toBytes(corners.data(), corners.size() * sizeof(int));
    }
    void _setTrianglesInContext(OpenMM::Context& context, const char* data, size_t size) {
        const int* corners = reinterpret_cast<const int*>(data);
        $self->setTrianglesInContext(context, std::vector<int>(corners, corners + size / sizeof(int)));
    }
    PyObject* _getPermutationInContext(OpenMM::Context& context) {
        std::vector<int> permutation = $self->getPermutationInContext(context);
        return toBytes(permutation.data(), permutation.size() * sizeof(int));
    }
    void _setPermutationInContext(OpenMM::Context& context, const char* data, size_t size) {
        const int* vertices = reinterpret_cast<const int*>(data);
        $self->setPermutationInContext(context, std::vector<int>(vertices, vertices + size / sizeof(int)));
    }
    PyObject* _getVirial(OpenMM::Context& context, int groups) {
        std::vector<double> virial = $self->getVirial(context, groups);
        return toBytes(virial.data(), virial.size() * sizeof(double));
    }
    PyObject* _saveConnectivity(OpenMM::Context& context) {
        std::string saved = $self->saveConnectivity(context);
        return toBytes(saved.data(), saved.size());
    }
    void _restoreConnectivity(OpenMM::Context& context, const char* data, size_t size) {
        $self->restoreConnectivity(context, std::string(data, size));
    }
}

%{
template <class Mover>
static PyObject* toDict(const Mover& mover, OpenMM::Context& context) {
    PyObject* statistics = PyDict_New();
    for (const auto& entry : mover.getStatistics(context)) {
        PyObject* value = PyFloat_FromDouble(entry.second);
        PyDict_SetItemString(statistics, entry.first.c_str(), value);
        Py_DECREF(value);
    }
    return statistics;
}
%}
%{
static std::vector<double> toDoubles(const char* data, size_t size) {
    const double* numbers = reinterpret_cast<const double*>(data);
    return std::vector<double>(numbers, numbers + size / sizeof(double));
}
%}
%extend HelfrichPlugin::MembraneForce {
    void _setVertexBuffer(const char* data, size_t size) {
        $self->setVertexNumbers(toDoubles(data, size));
    }
    PyObject* _vertexBuffer() {
        const std::vector<double>& numbers = $self->getVertexNumbers();
        return toBytes(numbers.data(), numbers.size() * sizeof(double));
    }
    void _setReferenceBoxBuffer(const char* data, size_t size) {
        $self->setReferenceBox(toDoubles(data, size));
    }
    PyObject* _referenceBoxBuffer() {
        const std::vector<double>& vectors = $self->getReferenceBox();
        return toBytes(vectors.data(), vectors.size() * sizeof(double));
    }
}

%extend HelfrichPlugin::LineTensionForce {
    PyObject* _getDomainsInContext(OpenMM::Context& context) {
        std::vector<int> domains = $self->getDomainsInContext(context);
        return toBytes(domains.data(), domains.size() * sizeof(int));
    }
}

%extend HelfrichPlugin::ParticleSurfaceForce {
    void _setParticleBuffer(const char* data, size_t size) {
        const int* indices = reinterpret_cast<const int*>(data);
        $self->setParticles(std::vector<int>(indices, indices + size / sizeof(int)));
    }
    PyObject* _particleBuffer() {
        const std::vector<int>& indices = $self->getParticles();
        return toBytes(indices.data(), indices.size() * sizeof(int));
    }
}

%extend HelfrichPlugin::MonteCarloSurfaceMover {
    PyObject* _getStatistics(OpenMM::Context& context) {
        return toDict(*$self, context);
    }
}

%extend HelfrichPlugin::MonteCarloMembraneTension {
    PyObject* _getStatistics(OpenMM::Context& context) {
        return toDict(*$self, context);
    }
    PyObject* _saveState(OpenMM::Context& context) {
        std::string saved = $self->saveState(context);
        return toBytes(saved.data(), saved.size());
    }
    void _restoreState(OpenMM::Context& context, const char* data, size_t size) {
        $self->restoreState(context, std::string(data, size));
    }
}

%extend HelfrichPlugin::SurfaceViscosityThermostat {
    PyObject* _saveState(OpenMM::Context& context) {
        std::string saved = $self->saveState(context);
        return toBytes(saved.data(), saved.size());
    }
    void _restoreState(OpenMM::Context& context, const char* data, size_t size) {
        $self->restoreState(context, std::string(data, size));
    }
}

/* `system.getForce(i)` and XML give plain openmm.Force objects; each class tells and casts its own. */
%define MEMBRANE_FORCE(CLASS)
%extend HelfrichPlugin::CLASS {
    static bool isinstance(OpenMM::Force& force) {
        return dynamic_cast<HelfrichPlugin::CLASS*>(&force) != nullptr;
    }
    static HelfrichPlugin::CLASS& cast(OpenMM::Force& force) {
        auto* found = dynamic_cast<HelfrichPlugin::CLASS*>(&force);
        if (found == nullptr)
            throw OpenMM::OpenMMException(#CLASS ": cannot cast the force \"" + force.getName() +
                                          "\", which is of another class");
        return *found;
    }
}
%include "openmm-helfrich/CLASS.h"
%enddef

/* The same of XML and CompoundIntegrators, which give plain openmm.Integrator objects. */
%define VARIABLE_MASS_INTEGRATOR(CLASS)
%extend HelfrichPlugin::CLASS {
    static bool isinstance(OpenMM::Integrator& integrator) {
        return dynamic_cast<HelfrichPlugin::CLASS*>(&integrator) != nullptr;
    }
    static HelfrichPlugin::CLASS& cast(OpenMM::Integrator& integrator) {
        auto* found = dynamic_cast<HelfrichPlugin::CLASS*>(&integrator);
        if (found == nullptr)
            throw OpenMM::OpenMMException(#CLASS ": cannot cast an integrator that is of another class");
        return *found;
    }
}
%include "openmm-helfrich/CLASS.h"
%enddef

%template(_IntVector) std::vector<int>;
%template(_DoubleVector) std::vector<double>;
%include "openmm-helfrich/internal/HelfrichForce.h"
%include "openmm-helfrich/TriangulatedForce.h"
%include "openmm-helfrich/MonteCarloMover.h"
%template(_TriangulatedMover) HelfrichPlugin::MonteCarloMover<HelfrichPlugin::TriangulatedForce>;
%template(_Mover) HelfrichPlugin::MonteCarloMover<HelfrichPlugin::HelfrichForce>;
%include "openmm-helfrich/MonteCarloSurfaceMover.h"
%include "openmm-helfrich/MembraneForce.h"
%include "OpenMMHelfrich.h"
HELFRICH_FORCES(MEMBRANE_FORCE)
MEMBRANE_FORCE(MonteCarloBondFlip)
MEMBRANE_FORCE(MonteCarloDomainSwap)
MEMBRANE_FORCE(MonteCarloMembraneTension)
MEMBRANE_FORCE(SurfaceViscosityThermostat)

%extend HelfrichPlugin::VariableMassIntegrator {
    PyObject* _getMasses() {
        std::vector<double> masses = $self->getMasses();
        return toBytes(masses.data(), masses.size() * sizeof(double));
    }
}
%include "openmm-helfrich/VariableMassIntegrator.h"
VARIABLE_MASS_INTEGRATOR(VariableMassVerletIntegrator)
VARIABLE_MASS_INTEGRATOR(VariableMassLangevinIntegrator)

/* For platforms.py: why a System is not one for the platform Helfrich, or an empty text. */
%inline %{
std::string _why_not_helfrich(const OpenMM::System& system, const OpenMM::Integrator& integrator) {
    return Helfrich_Platform_check(&system, &integrator) == 0 ? "" : HelfrichPlugin::lastError();
}
%}
