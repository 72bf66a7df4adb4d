#ifndef HELFRICH_FORCE_H_
#define HELFRICH_FORCE_H_

#include "Core.h"

#include <openmm/Force.h>
#include <openmm/OpenMMException.h>

#include <string>

namespace HelfrichPlugin {

/**
 * An OpenMM Force of this plugin, which knows its class and has its implementation made by the library.
 */
class HelfrichForce : public OpenMM::Force {
public:
    /**
     * Get the name of the class, as messages and XML have it.
     */
    const std::string& getTypeName() const {
        return type;
    }

protected:
    /**
     * @param type  the name of the class
     */
    explicit HelfrichForce(const std::string& type) : type(type) {
        setName(type);
    }
    OpenMM::ForceImpl* createImpl() const;
    [[noreturn]] void fail(const std::string& message) const {
        throw OpenMM::OpenMMException(type + ": " + message);
    }

private:
    std::string type;
};

#ifndef SWIG

inline OpenMM::ForceImpl* HelfrichForce::createImpl() const {
    void* impl = Helfrich_createImpl(static_cast<const OpenMM::Force*>(this));
    if (impl == nullptr)
        throw OpenMM::OpenMMException(lastError());
    return static_cast<OpenMM::ForceImpl*>(impl);
}

#endif /*SWIG*/

} // namespace HelfrichPlugin

#endif /*HELFRICH_FORCE_H_*/
