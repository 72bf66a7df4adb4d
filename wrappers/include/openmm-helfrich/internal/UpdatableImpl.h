#ifndef HELFRICH_UPDATABLE_IMPL_H_
#define HELFRICH_UPDATABLE_IMPL_H_

#include <openmm/internal/ContextImpl.h>
#include <openmm/internal/ForceImpl.h>

namespace HelfrichPlugin {

/**
 * What a force asks of its implementation. The force classes are compiled into several libraries, the
 * implementation into the plugin only; this interface is all that the former see of the latter.
 */
class UpdatableImpl {
public:
    virtual ~UpdatableImpl() {
    }
    /** Copy the scalars of the force. */
    virtual void updateParametersInContext(OpenMM::ContextImpl& context) = 0;
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_UPDATABLE_IMPL_H_*/
