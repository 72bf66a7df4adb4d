#include "MembraneForceImpl.h"
#include "PlatformChoice.h"

#include <openmm/System.h>
#include <openmm/reference/ReferencePlatform.h>

#include <algorithm>

using namespace HelfrichPlugin;
using namespace OpenMM;
using std::map;
using std::string;
using std::vector;

MembraneForceImpl::MembraneForceImpl(const MembraneForce& owner)
    : CustomCPPForceImpl(owner), OnMembrane(owner.getTypeName()), owner(owner), term(), hasKinds(false), inPlace(false),
      native(false), group(owner.getForceGroup()), periodic(owner.usesPeriodicBoundaryConditions()) {
    // OpenMM asks for the default parameters before it initialises the force.
    for (int i = 0; i < owner.getNumParameters(); i++)
        contextParameters.push_back(owner.getContextParameter(owner.getParameterName(i)));
    for (int i = 0; i < owner.getNumEnergyParameterDerivatives(); i++)
        derivatives.push_back(owner.getEnergyParameterDerivativeName(i));
}

MembraneForceImpl::~MembraneForceImpl() {
    if (membrane != nullptr)
        membrane->leave(this);
}

void MembraneForceImpl::initialize(ContextImpl& context) {
    PlatformChoice::end();
    inPlace = dynamic_cast<const ReferencePlatform*>(&context.getPlatform()) != nullptr;
    check(Helfrich_Potential_find(owner.getTypeName().c_str(), &term.potential));
    hasKinds = Helfrich_Potential_hasKinds(owner.getTypeName().c_str()) != 0;
    for (int i = 0; i < owner.getNumParameters(); i++) {
        HelfrichParameterInfo info;
        check(Helfrich_Potential_parameter(owner.getTypeName().c_str(), i, &info));
        isOfVertices.push_back(info.per == 1);
    }
    term.wantsDerivatives = !derivatives.empty();
    membrane = SharedMembrane::acquire(owner.getTypeName(), context, owner.getTriangles());
    try {
        membrane->checkAgreement(*this);
        membrane->checkJoining(owner.getTypeName(), term.potential);
        copyValues();
        native = membrane->startNative(owner, context, term.potential);
        if (!inPlace && !native && !derivatives.empty())
            throw OpenMMException(owner.getTypeName() + ": energy parameter derivatives need the Reference, CPU or " +
                                  "Helfrich platform, or the backend \"native\"; the platform " +
                                  context.getPlatform().getName() + " does not evaluate this force itself");
        for (const string& name : derivatives)
            if (native)
                membrane->requestDerivative(name);
    } catch (...) {
        // OpenMM will not delete this object any more; the membrane shall not stay for ever.
        membrane.reset();
        throw;
    }
    membrane->join(this);
    if (!inPlace && !native)
        CustomCPPForceImpl::initialize(context);
}

void MembraneForceImpl::copyValues() {
    HelfrichTerm updated = term;
    updated.form = owner.getForm();
    updated.switches = owner.getSwitches();
    vector<vector<double>> copies;
    for (int i = 0; i < owner.getNumParameters(); i++) {
        const string& name = owner.getParameterName(i);
        updated.values[i] = owner.getParameterValue(name);
        copies.push_back(owner.getElementValues(name));
        if (!copies.back().empty() && !contextParameters[i].empty())
            throw OpenMMException(owner.getTypeName() + ": " + name + " has both values for single elements and the " +
                                  "Context parameter \"" + contextParameters[i] + "\"; choose one of them");
        if (isOfVertices[i])
            membrane->arrange(copies.back());
        updated.fields[i] = copies.back().data();
        updated.fieldLengths[i] = (int64_t) copies.back().size();
    }
    vector<int> indices = owner.getParticles();
    updated.particles = indices.data();
    updated.numParticles = (int64_t) indices.size();
    vector<double> rows = owner.getVertexNumbers(), vectors = owner.getReferenceBox();
    if (hasKinds)
        membrane->arrange(rows);
    std::unique_ptr<HelfrichNumbers, Destroy> changed;
    if (rows != vertexNumbers || vectors != referenceBox || copies != fields) {
        changed.reset(Helfrich_Numbers_create(numbers.get(), rows.data(), (int64_t) rows.size(),
                                              vectors.empty() ? nullptr : vectors.data()));
        updated.numbers = changed.get();
    }
    membrane->checkTerm(owner.getTypeName(), updated);
    membrane->checkParticles(owner.getTypeName(), updated);
    // Moving the vectors leaves their contents where the term points.
    fields = std::move(copies);
    particles = std::move(indices);
    vertexNumbers = std::move(rows);
    referenceBox = std::move(vectors);
    if (changed != nullptr)
        numbers = std::move(changed);
    term = updated;
    membrane->forgetKinds();
}

void MembraneForceImpl::visitKinds(const std::function<void(const vector<double>& values)>& visit) const {
    for (size_t i = 0; i < fields.size(); i++)
        if (isOfVertices[i] && !fields[i].empty())
            visit(fields[i]);
    if (hasKinds)
        visit(vertexNumbers);
}

void MembraneForceImpl::rearrange(const vector<uint32_t>& sources, uint64_t version) {
    bool hasChanged = false;
    auto move = [&](vector<double>& values) {
        hasChanged = true;
        const vector<double> before(values);
        for (size_t i = 0; i < sources.size(); i++)
            values[i] = before[sources[i]];
    };
    for (size_t i = 0; i < fields.size(); i++)
        if (isOfVertices[i] && !fields[i].empty())
            move(fields[i]);
    if (hasKinds)
        move(vertexNumbers);
    if (hasChanged)
        check(Helfrich_Numbers_rearrange(numbers.get(), vertexNumbers.data(), (int64_t) vertexNumbers.size(), version));
}

vector<string> MembraneForceImpl::getKernelNames() {
    // OpenMM asks for this before it chooses a platform.
    PlatformChoice::begin(*this);
    // On Reference and CPU the kernel is not used, but both have it.
    return CustomCPPForceImpl::getKernelNames();
}

bool MembraneForceImpl::isInGroups(int groups) const {
    return (groups & (1 << group)) != 0;
}

double MembraneForceImpl::calcForcesAndEnergy(ContextImpl& context, bool includeForces, bool includeEnergy,
                                              int groups) {
    if (native) {
        if (membrane->isLeader(*this, groups))
            membrane->evaluateNatively(owner.getTypeName(), context, groups, includeForces, includeEnergy);
        // The energy is on the device.
        return 0;
    }
    if (!inPlace)
        return CustomCPPForceImpl::calcForcesAndEnergy(context, includeForces, includeEnergy, groups);
    if (!membrane->isLeader(*this, groups))
        return 0;
    auto* data = static_cast<ReferencePlatform::PlatformData*>(context.getPlatformData());
    // OpenMM clears the derivatives before each evaluation, and may want them without the energy.
    return membrane->evaluate(owner.getTypeName(), context, groups, *data->positions, includeEnergy,
                              includeForces ? data->forces : nullptr, data->energyParameterDerivatives);
}

double MembraneForceImpl::computeForce(ContextImpl& context, const vector<Vec3>& positions, vector<Vec3>& forces) {
    std::fill(forces.begin(), forces.end(), Vec3());
    // OpenMM notes the groups before it starts any force.
    int groups = context.getLastForceGroups();
    if (!membrane->isLeader(*this, groups))
        return 0;
    return membrane->evaluate(owner.getTypeName(), context, groups, positions, true, &forces, nullptr);
}

map<string, double> MembraneForceImpl::getDefaultParameters() {
    map<string, double> defaults;
    for (int i = 0; i < owner.getNumParameters(); i++) {
        if (contextParameters[i].empty())
            continue;
        double value = owner.getParameterValue(owner.getParameterName(i));
        auto [entry, isNew] = defaults.emplace(contextParameters[i], value);
        if (!isNew && entry->second != value)
            throw OpenMMException(owner.getTypeName() +
                                  ": two scalars with different values share the Context "
                                  "parameter \"" +
                                  contextParameters[i] + "\"; give them one value");
    }
    return defaults;
}

vector<std::pair<int, int>> MembraneForceImpl::getBondedParticles() const {
    return membrane->getEdges();
}

void MembraneForceImpl::updateParametersInContext(ContextImpl& context) {
    if (owner.getTriangles() != membrane->getTriangles())
        throw OpenMMException(owner.getTypeName() + ": the triangles have changed since the Context was made; call " +
                              "Context::reinitialize()");
    if (owner.usesPeriodicBoundaryConditions() != periodic)
        throw OpenMMException(owner.getTypeName() +
                              ": whether it uses periodic boundary conditions has changed since " +
                              "the Context was made; call Context::reinitialize()");
    for (size_t i = 0; i < contextParameters.size(); i++)
        if (owner.getContextParameter(owner.getParameterName((int) i)) != contextParameters[i])
            throw OpenMMException(owner.getTypeName() + ": the Context parameter of " +
                                  owner.getParameterName((int) i) +
                                  " has changed since the Context was made; call Context::reinitialize()");
    copyValues();
    context.systemChanged();
}

bool MembraneForceImpl::usesContextParameters() const {
    return std::any_of(contextParameters.begin(), contextParameters.end(),
                       [](const string& name) { return !name.empty(); });
}

HelfrichTerm MembraneForceImpl::getTerm(ContextImpl& context) const {
    HelfrichTerm current = term;
    for (size_t i = 0; i < contextParameters.size(); i++)
        if (!contextParameters[i].empty())
            current.values[i] = context.getParameter(contextParameters[i]);
    return current;
}

void MembraneForceImpl::findDerivatives(const NativeMembrane& native, int* numbers) const {
    for (const string& name : derivatives)
        for (size_t i = 0; i < contextParameters.size(); i++)
            if (contextParameters[i] == name)
                numbers[i] = native.findDerivative(name);
}

void MembraneForceImpl::addDerivatives(const HelfrichContribution& contribution, map<string, double>& sums) const {
    for (const string& name : derivatives)
        for (size_t i = 0; i < contextParameters.size(); i++)
            if (contextParameters[i] == name)
                sums[name] += contribution.byParameter[i];
}
