/*
 * Context::reinitialize() destroys the forces' implementations and makes others, on the same thread, and may then load
 * a checkpoint, which on most platforms does not hold the connectivity. So a membrane with movers leaves it behind, and
 * the next membrane on the same triangles takes it up if its Context has come to the same fingerprints and number of
 * steps (and to the same positions, where an integrator has set a fingerprint back). Each thread keeps what one Context
 * has left.
 */

#include "SavedConnectivity.h"
#include "SharedMembrane.h"
#include "SurfaceMoverImpl.h"

#include <openmm/reference/ReferencePlatform.h>

using namespace HelfrichPlugin;
using namespace OpenMM;
using std::string;
using std::vector;

namespace {

/** OpenMM's own array, on Reference and what derives from it. */
const vector<Vec3>& getPositions(ContextImpl& context) {
    return *static_cast<ReferencePlatform::PlatformData*>(context.getPlatformData())->positions;
}

} // namespace

thread_local SharedMembrane::Estate SharedMembrane::estate;
thread_local bool SharedMembrane::hasNoEstate = false;

SharedMembrane::Estate::~Estate() {
    hasNoEstate = true;
}

void SharedMembrane::leaveBehind(ContextImpl& context) {
    if (hasNoEstate)
        return;
    try {
        // Of several membranes each adds its own.
        if (estate.context != &context) {
            estate.context = &context;
            estate.left.clear();
        }
        if (inherited != nullptr)
            estate.left.push_back(std::move(*inherited));
        Left left = {triangles, {}, context.getStepCount(), 0, ""};
        bool isNew = left.step == 0;
        for (SurfaceMoverImpl* mover : movers) {
            if (mover == nullptr)
                continue;
            // A State may have been loaded.
            if (!mover->isInUse() || !mover->isRight(context))
                return;
            double value = mover->getAnnounced(context);
            left.parameters[mover->getParameter()] = value;
            isNew = isNew && value == 0;
            if (value != mover->getFingerprint() && mover->isInPlace())
                left.checksum = findChecksum(getPositions(context));
        }
        // Every other new Context would be taken for this one.
        if (isNew)
            return;
        left.saved = save(context);
        estate.left.push_back(std::move(left));
    } catch (...) {
        // A destructor must not throw. Without this, the State of the Context is refused by the next one.
    }
}

void SharedMembrane::inherit() {
    if (hasNoEstate)
        return;
    estate.context = nullptr;
    for (Left& left : estate.left)
        if (left.triangles == triangles) {
            inherited.reset(new Left(std::move(left)));
            left.triangles.clear();
            return;
        }
}

void SharedMembrane::settle(ContextImpl& context) {
    std::lock_guard<std::mutex> lock(settling);
    if (!parts.empty())
        followParts(context);
    if (inherited == nullptr)
        return;
    if (isHeir(context)) {
        SavedConnectivity saved("reinitialize", inherited->saved);
        take("reinitialize", saved);
        tellMovers(context, &saved);
    }
    inherited.reset();
}

bool SharedMembrane::isHeir(ContextImpl& context) const {
    if (context.getStepCount() != inherited->step)
        return false;
    // A checkpoint brings the parameters even where a mover has been removed.
    const auto& parameters = context.getParameters();
    for (const auto& [name, value] : inherited->parameters) {
        auto found = parameters.find(name);
        if (found == parameters.end() || found->second != value)
            return false;
    }
    return inherited->checksum == 0 || inherited->checksum == findChecksum(getPositions(context));
}
