/*
 * What a SharedMembrane evaluates, and where.
 */

#include "Barostats.h"
#include "HelfrichPlatform.h"
#include "MembraneForceImpl.h"
#include "SharedMembrane.h"

#include <openmm/System.h>

#include <algorithm>
#include <iostream>
#include <mutex>

using namespace HelfrichPlugin;
using namespace OpenMM;
using std::string;
using std::vector;

bool SharedMembrane::isPeriodic() const {
    return !members.empty() && members[0]->isPeriodic();
}

const double* SharedMembrane::findBox(ContextImpl& context) {
    if (!isPeriodic())
        return nullptr;
    context.getPeriodicBoxVectors(box[0], box[1], box[2]);
    return reinterpret_cast<const double*>(box);
}

bool SharedMembrane::isLeader(const MembraneForceImpl& member, int groups) const {
    for (const MembraneForceImpl* other : members)
        if (other->isInGroups(groups) && other->isNative() == member.isNative())
            return other == &member;
    return false;
}

bool SharedMembrane::startNative(const MembraneForce& force, ContextImpl& context, int potential) {
    int wish = Helfrich_Membrane_wishesNative(core);
    if (wish == 0)
        return false;
    bool isMust = wish == 2;
    string reason = NativeMembrane::whyNot(context);
    if (!reason.empty()) {
        // OpenMM's minimizer has a second Context on the processor for forces that are too large for its own.
        if (isMust && !NativeMembrane::isElsewhere(context.getSystem()))
            throw OpenMMException(force.getTypeName() + ": the backend \"native\" cannot be had here: " + reason);
        return false;
    }
    // An OpenCL driver that computes on the processor is slower there than our own code, which has no derivatives
    // there.
    if (!isMust && force.getNumEnergyParameterDerivatives() == 0 && NativeMembrane::isOnProcessor(context))
        return false;
    // Contacts and volumes in a periodic box are for the processor, whatever evaluates the rest.
    if (!Helfrich_Native_canEvaluate(potential, force.usesPeriodicBoundaryConditions()))
        return false;
    if (native != nullptr)
        return true;
    const NativeMembrane* sibling = nullptr;
    for (const auto& other : findAll(context))
        if (other->native != nullptr)
            sibling = other->native.get();
    try {
        native.reset(new NativeMembrane(context, core, getEdges(), sibling));
    } catch (const std::exception& error) {
        if (isMust)
            throw OpenMMException(force.getTypeName() + ": the backend \"native\" cannot be had here: " + error.what());
        static std::once_flag said;
        std::call_once(said, [&] {
            std::cerr << "openmm-helfrich: the platform " << context.getPlatform().getName()
                      << " cannot compile the membrane's kernels; the processor takes over: " << error.what() << "\n";
        });
        return false;
    }
    return true;
}

void SharedMembrane::evaluateNatively(const string& subject, ContextImpl& context, int groups, bool forces,
                                      bool energy) {
    settle(context);
    collect(context, groups, Which::Native);
    derivativeNumbers.assign(HELFRICH_MAX_PARAMETERS * terms.size(), -1);
    bool wantsSums = energy;
    for (size_t i = 0; i < active.size(); i++)
        if (terms[i].wantsDerivatives) {
            active[i]->findDerivatives(*native, &derivativeNumbers[HELFRICH_MAX_PARAMETERS * i]);
            wantsSums = true;
        }
    native->evaluate(subject, context, terms, derivativeNumbers, forces, wantsSums, energy, findBox(context));
    noteSpanning(subject, context);
}

void SharedMembrane::noteSpanning(const string& subject, ContextImpl& context) {
    if (spans || !Helfrich_Membrane_spans(core))
        return;
    refuseTearing(subject, context.getSystem());
    spans = true;
}

void SharedMembrane::collect(ContextImpl& context, int groups, Which which) {
    active.clear();
    terms.clear();
    for (MembraneForceImpl* member : members)
        if (member->isInGroups(groups) && (which == Which::All || member->isNative() == (which == Which::Native))) {
            active.push_back(member);
            terms.push_back(member->getTerm(context));
            // Context parameters can be anything by now; the message shall name the force whose they are.
            if (member->usesContextParameters())
                checkTerm(member->getOwner().getTypeName(), terms.back());
        }
}

bool SharedMembrane::hasContacts() const {
    return std::any_of(members.begin(), members.end(),
                       [](const MembraneForceImpl* member) { return member->isContact(); });
}

void SharedMembrane::joinCrowd(bool isAlone) {
    inCrowd = true;
    if (isAlone)
        Helfrich_Membrane_setThreads(core, 1);
}

bool SharedMembrane::prepare(const Computation& computation) {
    settle(computation.context);
    collect(computation.context, computation.groups, Which::Others);
    contributions.assign(terms.size(), HelfrichContribution());
    return !active.empty();
}

HelfrichTurn SharedMembrane::getTurn(const Computation& computation) {
    bool wantsContributions = computation.includeEnergy ||
        (computation.includeDerivatives &&
         std::any_of(terms.begin(), terms.end(), [](const HelfrichTerm& term) { return term.wantsDerivatives != 0; }));
    return {active[0]->getOwner().getTypeName().c_str(),
            core,
            terms.data(),
            (int64_t) terms.size(),
            wantsContributions ? contributions.data() : nullptr,
            findBox(computation.context)};
}

double SharedMembrane::evaluate(const string& subject, ContextImpl& context, int groups, const vector<Vec3>& positions,
                                bool includeEnergy, vector<Vec3>* forces, std::map<string, double>* derivatives) {
    // Vec3 is three doubles and nothing else, but its operator[] returns copies.
    static_assert(sizeof(Vec3) == 3 * sizeof(double), "an array of Vec3 is an array of coordinates");
    Computation computation = {context, groups, positions, includeEnergy, forces, derivatives != nullptr};
    HelfrichPlatform::PlatformData* data = HelfrichPlatform::getData(context);
    if (data == nullptr || !data->crowd.evaluate(*this, computation)) {
        prepare(computation);
        HelfrichTurn turn = getTurn(computation);
        check(Helfrich_Membrane_evaluate(turn.subject, turn.membrane, turn.terms, turn.numTerms,
                                         (int64_t) positions.size(), reinterpret_cast<const double*>(positions.data()),
                                         turn.boxVectors, turn.contributions,
                                         forces == nullptr ? nullptr : reinterpret_cast<double*>(forces->data())));
    }
    noteSpanning(subject, context);
    double energy = 0;
    for (size_t i = 0; i < active.size(); i++) {
        energy += contributions[i].energy;
        if (derivatives != nullptr)
            active[i]->addDerivatives(contributions[i], *derivatives);
    }
    return energy;
}

vector<double> SharedMembrane::sumVirials(ContextImpl& context, int groups) {
    vector<Vec3> positions;
    context.getPositions(positions);
    vector<double> sum(9, 0.0);
    for (const auto& membrane : findAll(context)) {
        membrane->settle(context);
        membrane->collect(context, groups);
        if (membrane->active.empty())
            continue;
        const string& subject = membrane->active[0]->getOwner().getTypeName();
        check(Helfrich_Membrane_addVirial(subject.c_str(), membrane->core, membrane->terms.data(),
                                          (int64_t) membrane->terms.size(), (int64_t) positions.size(),
                                          reinterpret_cast<const double*>(positions.data()), membrane->findBox(context),
                                          sum.data()));
    }
    return sum;
}
