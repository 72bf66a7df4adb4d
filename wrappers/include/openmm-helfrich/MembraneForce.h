#ifndef HELFRICH_MEMBRANE_FORCE_H_
#define HELFRICH_MEMBRANE_FORCE_H_

#include "TriangulatedForce.h"
#include "internal/UpdatableImpl.h"

#include <string>
#include <vector>

namespace HelfrichPlugin {

/**
 * The common part of all forces on a membrane: a triangulated surface, and named scalars.
 *
 * The triangles refer to particles of the System. They must form one or several oriented 2-manifold surfaces, of any
 * genus, closed or with borders, each triangle counter-clockwise seen from outside; that neighbours agree is checked
 * when a Context is created. If all run clockwise, forces on the volume refuse them, and to others the inside is the
 * outside. Particles that no triangle mentions feel no force. A border is pinned where its particles have no mass.
 *
 * Forces on the same triangles in one Context share one evaluation of the geometry. If a triangle loses all its area
 * during a simulation, its normal and with it the energy's gradient are undefined; the evaluation then throws an
 * OpenMMException that names the triangle, as it does for a particle at a position that is not finite. The Context
 * stays usable with other positions.
 */
class MembraneForce : public TriangulatedForce {
public:
    /**
     * Get the number of scalar parameters.
     */
    int getNumParameters() const {
        return (int) parameters.size();
    }
    /**
     * Get the name of a scalar parameter, as setContextParameter() takes it.
     *
     * @param index  the index of the parameter
     */
    const std::string& getParameterName(int index) const;
    /**
     * Get the value of a scalar parameter in OpenMM's units (nm, kJ/mol).
     *
     * @param name  the name of the parameter
     */
    double getParameterValue(const std::string& name) const;
    /**
     * Set the value of a scalar parameter; values of single elements, if there are any, are given up.
     *
     * @param name   the name of the parameter
     * @param value  the value in OpenMM's units (nm, kJ/mol)
     */
    void setParameterValue(const std::string& name, double value);
    /**
     * Give a scalar its own value for each vertex, triangle, edge or particle, whichever the potential allows.
     *
     * @param name    the name of the parameter
     * @param values  in OpenMM's units: for each vertex in ascending order of particle index, triangle, edge by the
     *                particles at its ends, or particle in the order given. An empty list goes back to the scalar.
     */
    void setElementValues(const std::string& name, const std::vector<double>& values);
    /**
     * Get the values of a parameter for each vertex, triangle, edge or particle, empty if it is a scalar.
     *
     * @param name  the name of the parameter
     */
    const std::vector<double>& getElementValues(const std::string& name) const;
    /**
     * Let a parameter of the Context take the place of a scalar, so that Context::setParameter() changes
     * it during a simulation. Its initial value is that of the scalar. Several forces may share a
     * parameter of the Context if their initial values agree.
     *
     * @param parameter  the name of the scalar, for example "target"
     * @param name       the name of the Context parameter; empty to go back to the scalar itself
     */
    void setContextParameter(const std::string& parameter, const std::string& name);
    /**
     * Get the name of the Context parameter that stands in for a scalar, empty if there is none.
     *
     * @param parameter  the name of the scalar
     */
    const std::string& getContextParameter(const std::string& parameter) const;
    /**
     * Ask for the derivative of the energy with respect to a Context parameter, which Context::getState() then
     * returns; on OpenCL, CUDA and HIP not of what the processor computes, as contacts. Asking twice changes nothing.
     *
     * @param name  the name of the Context parameter, given to setContextParameter() before
     */
    void addEnergyParameterDerivative(const std::string& name);
    /**
     * Get the number of Context parameters whose derivatives are asked for.
     */
    int getNumEnergyParameterDerivatives() const {
        return (int) derivatives.size();
    }
    /**
     * Get the name of a Context parameter whose derivative is asked for.
     *
     * @param index  the index of the derivative
     */
    const std::string& getEnergyParameterDerivativeName(int index) const;
    /**
     * Copy scalars, values of elements, form and switches of this object to a Context. What is a
     * Context parameter stays as it is there (use Context::setParameter()); changed triangles are
     * refused (use Context::reinitialize()).
     *
     * @param context  the Context to update
     */
    void updateParametersInContext(OpenMM::Context& context);
    /**
     * Choose what computes the force in Contexts that are made from now on: the processor or a GPU. Forces
     * on the same triangles of one Context are computed together, so those of them that have a choice of
     * their own must have the same one; the others follow.
     *
     * @param backend  "cpu"; "native", OpenMM's platform OpenCL, CUDA or HIP itself; "gpu", or with a precision
     *                 "gpu:single" or "gpu:double"; "auto", which is native on these platforms where the device is a
     *                 GPU, and elsewhere takes the GPU for large meshes if it is faster and the processor if the GPU
     *                 fails; or empty, the default, for what has been chosen for the whole process. "gpu@1" names an
     *                 adapter. Contacts, and on "gpu" a surface that spans a periodic box, are computed on the
     *                 processor in any case.
     */
    void setBackend(const std::string& backend);
    /**
     * Get what the force has chosen, empty if it follows the process.
     */
    const std::string& getBackend() const {
        return backend;
    }
    /**
     * Set whether the surface lives in the periodic box of the Context, which may be triclinic. Each edge then
     * connects nearest images, so positions may be wrapped into the box or not: the result has the same bits. A surface
     * may cross faces of the box, or span it: a sheet, a tube, a surface that goes on in three directions. Every edge
     * must be shorter than half of the least distance between opposite faces; the evaluation throws an OpenMMException
     * that names one which is not.
     *
     * Forces on the same triangles must agree. It is not periodic unless this is called or, in Python, the force is
     * made of a Mesh that has a box; triangles alone say nothing of a box. Without it a surface that crosses the box is
     * taken with edges that go all the way back through it, and its energy is wrong without an error. Existing Contexts
     * do not change.
     *
     * @param periodic  whether it is periodic
     */
    void setUsesPeriodicBoundaryConditions(bool periodic) {
        isPeriodic = periodic;
    }
    /**
     * Get whether the surface lives in the periodic box of the Context.
     */
    bool usesPeriodicBoundaryConditions() const {
        return isPeriodic;
    }
    /**
     * Get the particles beside the vertices that the force acts on; most classes have none.
     */
    const std::vector<int>& getParticles() const {
        return particles;
    }
    /**
     * Get what the force has for each vertex, one vertex after the other in ascending order of particle index: the
     * reference of a SkalakForce, for example. Most classes have nothing.
     */
    const std::vector<double>& getVertexNumbers() const {
        return vertexNumbers;
    }
    /**
     * Set what the force has for each vertex. updateParametersInContext() tells existing Contexts.
     *
     * @param numbers  one vertex after the other, in ascending order of particle index: three coordinates of each in
     *                 the reference, nm, or the number of its domain
     */
    void setVertexNumbers(const std::vector<double>& numbers);
    /**
     * Get the vectors of the periodic box in which the reference is, nine numbers, nm; empty if there is none.
     */
    const std::vector<double>& getReferenceBox() const {
        return referenceBox;
    }
    /**
     * Say in which periodic box the reference of the force is. Its sides are then nearest images in this box, whatever
     * the Context's box becomes, so that its positions may be wrapped or not, and must be shorter than half of its
     * least width. A surface that spans the box needs it; without one the reference is taken as it is, in one piece.
     *
     * @param vectors  the box vectors a, b and c as OpenMM has them, nine numbers, nm; empty for none
     */
    void setReferenceBox(const std::vector<double>& vectors);
    /**
     * Get which form of the potential is computed, 0 if there are none.
     */
    int getForm() const {
        return form;
    }
    /**
     * Choose the form of the potential.
     *
     * @param form  the number of the form
     */
    void setForm(int form);
    /**
     * Get whether something is switched on.
     *
     * @param name  the name of the switch
     */
    bool getSwitch(const std::string& name) const;
    /**
     * Switch something on or off. updateParametersInContext() tells existing Contexts.
     *
     * @param name  the name of the switch
     * @param on    whether it shall be on
     */
    void setSwitch(const std::string& name, bool on);
    /**
     * Get the state of all switches, one bit for each in the core's order.
     */
    unsigned int getSwitches() const {
        return switches;
    }

protected:
    /**
     * @param type       the name of the class, under which the core knows the potential
     * @param triangles  the particle indices of the corners, three for each triangle
     * @param values     the scalars, in the core's order
     * @param form       the number of the form
     */
    MembraneForce(const std::string& type, const std::vector<int>& triangles, const std::vector<double>& values,
                  int form = 0);
    /** Set the particles beside the vertices that the force acts on. */
    void setOtherParticles(const std::vector<int>& indices) {
        particles = indices;
    }

private:
    struct Parameter {
        std::string name;
        double value;
        std::string contextParameter;
        /** Values of single elements; empty if there is only the scalar. */
        std::vector<double> elementValues;
        /** Whether it may have those. */
        bool perElement;
    };
    int findParameter(const std::string& name) const;
    unsigned int findSwitch(const std::string& name) const;
    bool hasContextParameter(const std::string& name) const;

    std::vector<Parameter> parameters;
    std::vector<std::string> derivatives;
    std::vector<int> particles;
    std::vector<double> vertexNumbers, referenceBox;
    int form;
    unsigned int switches;
    std::string backend;
    bool isPeriodic;
};

#ifndef SWIG

inline MembraneForce::MembraneForce(const std::string& type, const std::vector<int>& triangles,
                                    const std::vector<double>& values, int form)
    : TriangulatedForce(type, triangles), form(0), switches(0), isPeriodic(false) {
    for (double value : values) {
        int index = (int) parameters.size();
        HelfrichParameterInfo info;
        check(Helfrich_Potential_parameter(getTypeName().c_str(), index, &info));
        check(Helfrich_Potential_check(getTypeName().c_str(), index, value));
        parameters.push_back({info.name, value, "", {}, info.per != 0});
    }
    if (form != 0)
        setForm(form);
}

inline const std::string& MembraneForce::getParameterName(int index) const {
    if (index < 0 || index >= getNumParameters())
        fail("there is no parameter " + std::to_string(index) + " among " + std::to_string(getNumParameters()));
    return parameters[index].name;
}

inline int MembraneForce::findParameter(const std::string& name) const {
    std::string known;
    for (int i = 0; i < getNumParameters(); i++) {
        if (parameters[i].name == name)
            return i;
        known += (i == 0 ? "" : ", ") + parameters[i].name;
    }
    fail("there is no parameter called \"" + name + "\"; known are: " + known);
}

inline double MembraneForce::getParameterValue(const std::string& name) const {
    return parameters[findParameter(name)].value;
}

inline void MembraneForce::setParameterValue(const std::string& name, double value) {
    int index = findParameter(name);
    check(Helfrich_Potential_check(getTypeName().c_str(), index, value));
    parameters[index].value = value;
    parameters[index].elementValues.clear();
}

inline void MembraneForce::setElementValues(const std::string& name, const std::vector<double>& values) {
    int index = findParameter(name);
    if (!parameters[index].perElement && !values.empty())
        fail(name + " is one value for the whole membrane; it cannot be given for single elements");
    for (size_t i = 0; i < values.size(); i++)
        if (Helfrich_Potential_check(getTypeName().c_str(), index, values[i]) != Helfrich_Success)
            throw OpenMM::OpenMMException(lastError() + " at index " + std::to_string(i));
    parameters[index].elementValues = values;
}

inline const std::vector<double>& MembraneForce::getElementValues(const std::string& name) const {
    return parameters[findParameter(name)].elementValues;
}

inline void MembraneForce::setContextParameter(const std::string& parameter, const std::string& name) {
    parameters[findParameter(parameter)].contextParameter = name;
    // A derivative with respect to a Context parameter that no scalar has any more would be meaningless.
    std::vector<std::string> kept;
    for (const std::string& derivative : derivatives)
        if (hasContextParameter(derivative))
            kept.push_back(derivative);
    derivatives = kept;
}

inline const std::string& MembraneForce::getContextParameter(const std::string& parameter) const {
    return parameters[findParameter(parameter)].contextParameter;
}

inline bool MembraneForce::hasContextParameter(const std::string& name) const {
    for (const Parameter& parameter : parameters)
        if (!name.empty() && parameter.contextParameter == name)
            return true;
    return false;
}

inline void MembraneForce::addEnergyParameterDerivative(const std::string& name) {
    if (!hasContextParameter(name))
        fail("no scalar has the Context parameter \"" + name + "\"; call setContextParameter() first");
    for (const std::string& derivative : derivatives)
        if (derivative == name)
            return;
    derivatives.push_back(name);
}

inline const std::string& MembraneForce::getEnergyParameterDerivativeName(int index) const {
    if (index < 0 || index >= getNumEnergyParameterDerivatives())
        fail("there is no derivative " + std::to_string(index));
    return derivatives[index];
}

inline void MembraneForce::setVertexNumbers(const std::vector<double>& numbers) {
    check(Helfrich_Potential_checkNumbers(getTypeName().c_str(), numbers.data(), (int64_t) numbers.size(), nullptr));
    vertexNumbers = numbers;
}

inline void MembraneForce::setReferenceBox(const std::vector<double>& vectors) {
    const char* name;
    if (Helfrich_Potential_numbers(getTypeName().c_str(), &name) != 3)
        fail("has no reference that could be in a box");
    if (!vectors.empty() && vectors.size() != 9)
        fail("the box of the reference needs nine numbers, got " + std::to_string(vectors.size()));
    check(
        Helfrich_Potential_checkNumbers(getTypeName().c_str(), nullptr, 0, vectors.empty() ? nullptr : vectors.data()));
    referenceBox = vectors;
}

inline void MembraneForce::setForm(int number) {
    const char *what, *name;
    check(Helfrich_Potential_form(getTypeName().c_str(), number, &what, &name));
    form = number;
}

inline unsigned int MembraneForce::findSwitch(const std::string& name) const {
    const char* found;
    for (int i = 0; Helfrich_Potential_switch(getTypeName().c_str(), i, &found) == Helfrich_Success; i++)
        if (name == found)
            return 1u << i;
    fail("there is no switch called \"" + name + "\"");
}

inline bool MembraneForce::getSwitch(const std::string& name) const {
    return (switches & findSwitch(name)) != 0;
}

inline void MembraneForce::setSwitch(const std::string& name, bool on) {
    unsigned int bit = findSwitch(name);
    switches = on ? switches | bit : switches & ~bit;
}

inline void MembraneForce::setBackend(const std::string& choice) {
    if (!choice.empty())
        check(Helfrich_checkBackend(getTypeName().c_str(), choice.c_str()));
    backend = choice;
}

inline void MembraneForce::updateParametersInContext(OpenMM::Context& context) {
    dynamic_cast<UpdatableImpl&>(getImplInContext(context)).updateParametersInContext(getContextImpl(context));
}

#endif /*SWIG*/

} // namespace HelfrichPlugin

#endif /*HELFRICH_MEMBRANE_FORCE_H_*/
