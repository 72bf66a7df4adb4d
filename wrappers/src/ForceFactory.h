#ifndef HELFRICH_FORCE_FACTORY_H_
#define HELFRICH_FORCE_FACTORY_H_

#include "OpenMMHelfrich.h"

#include <type_traits>

namespace HelfrichPlugin {

/** A force of a class without triangles, particles or a reference, and with scalars that every potential allows. */
template <class ForceClass>
MembraneForce* makeForce() {
    using Reference = std::vector<double>;
    std::vector<int> none;
    if constexpr (std::is_constructible_v<ForceClass, std::vector<int>, double, double, Reference>)
        return new ForceClass(none, 1.0, 1.0, Reference());
    else if constexpr (std::is_constructible_v<ForceClass, std::vector<int>, double, Reference>)
        return new ForceClass(none, 1.0, Reference());
    else if constexpr (std::is_constructible_v<ForceClass, std::vector<int>, double, std::vector<int>>)
        return new ForceClass(none, 1.0, none);
    else if constexpr (std::is_constructible_v<ForceClass, std::vector<int>, double, double>)
        return new ForceClass(none, 1.0, 1.0);
    else if constexpr (std::is_constructible_v<ForceClass, std::vector<int>, std::vector<int>, double, double>)
        return new ForceClass(none, none, 1.0, 1.0);
    else if constexpr (std::is_constructible_v<ForceClass, std::vector<int>, double, double, double>)
        return new ForceClass(none, 1.0, 1.0, 1.0);
    else
        return new ForceClass(none, 1.0);
}

/** The same for the name of a class. */
inline MembraneForce* makeForce(const std::string& name) {
#define MAKE(ForceClass)                                                                                               \
    if (name == #ForceClass)                                                                                           \
        return makeForce<ForceClass>();
    HELFRICH_FORCES(MAKE)
#undef MAKE
    throw OpenMM::OpenMMException(name + ": there is no such force class");
}

} // namespace HelfrichPlugin

#endif /*HELFRICH_FORCE_FACTORY_H_*/
