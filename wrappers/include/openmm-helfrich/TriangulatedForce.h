#ifndef HELFRICH_TRIANGULATED_FORCE_H_
#define HELFRICH_TRIANGULATED_FORCE_H_

#include "internal/ConnectivityImpl.h"
#include "internal/HelfrichForce.h"

#include <openmm/Context.h>

#include <string>
#include <vector>

namespace HelfrichPlugin {

/**
 * What acts on a triangulated surface of particles.
 *
 * The triangles are those that a Context begins with, and they tell which forces act on the same surface. Bond flips
 * (MonteCarloBondFlip) and setTrianglesInContext() change which particles are connected in a Context, for all forces on
 * the same triangles at once; triangles keep their numbers.
 */
class TriangulatedForce : public HelfrichForce {
public:
    /**
     * Add a triangle.
     *
     * @param particle1  the index of the first corner
     * @param particle2  the index of the second corner, counter-clockwise seen from outside
     * @param particle3  the index of the third corner
     * @return the index of the triangle that was added
     */
    int addTriangle(int particle1, int particle2, int particle3);
    /**
     * Get the number of triangles.
     */
    int getNumTriangles() const {
        return (int) triangles.size() / 3;
    }
    /**
     * Get the corners of a triangle.
     *
     * @param index            the index of the triangle
     * @param[out] particle1   the index of the first corner
     * @param[out] particle2   the index of the second corner
     * @param[out] particle3   the index of the third corner
     */
    void getTriangle(int index, int& particle1, int& particle2, int& particle3) const;
    /**
     * Get the corners of all triangles, one after the other.
     */
    const std::vector<int>& getTriangles() const {
        return triangles;
    }
    /**
     * Add many triangles.
     *
     * @param corners  the particle indices of the corners, three for each triangle
     */
    void addTriangles(const std::vector<int>& corners);
    /**
     * Get the corners of all triangles as they are in a Context now, one after the other.
     *
     * @param context  the Context
     */
    std::vector<int> getTrianglesInContext(OpenMM::Context& context) const;
    /**
     * Connect the particles of a surface in a Context in another way, for all forces on the same triangles. Positions
     * stay as they are, and so does the topology: each connected part of the surface keeps its particles and its number
     * of triangles.
     *
     * Only a MonteCarloBondFlip on the same triangles tells when positions of before come back: a Context without one
     * takes a State or checkpoint of before for one of the new triangles, and has the triangles of the force again
     * after Context::reinitialize(). (Checkpoints of platform Helfrich have the triangles themselves.) One of frequency
     * 0 flips nothing, and tells.
     *
     * @param context  the Context
     * @param corners  the particle indices of the corners, three for each triangle: as many triangles of the same
     *                 particles as there are, counter-clockwise seen from outside
     */
    void setTrianglesInContext(OpenMM::Context& context, const std::vector<int>& corners) const;
    /**
     * Get whose values the vertices of a surface have in a Context now: MonteCarloDomainSwap lets neighbours exchange
     * them. Vertex i has the values that forces were given for vertex permutation[i]; vertices are counted in ascending
     * order of particle index.
     *
     * @param context  the Context
     */
    std::vector<int> getPermutationInContext(OpenMM::Context& context) const;
    /**
     * Let the vertices of a surface in a Context have each other's values, in all forces on the same triangles:
     * rigidity and the like, and the number of the domain. What holds of setTrianglesInContext() without a
     * MonteCarloBondFlip holds here without a MonteCarloDomainSwap.
     *
     * @param context      the Context
     * @param permutation  for each vertex the one whose values it shall have, as they were given; each comes once
     */
    void setPermutationInContext(OpenMM::Context& context, const std::vector<int>& permutation) const;
    /**
     * Get all that restoreConnectivity() needs to go on with the same bits: the triangles of a Context, the order in
     * which sums are formed, the permutation of the vertices' values, and what a MonteCarloBondFlip and a
     * MonteCarloDomainSwap on them have come to. Positions are not among it. The bytes have a checksum and are those of
     * processors with little-endian numbers.
     *
     * @param context  the Context
     */
    std::string saveConnectivity(OpenMM::Context& context) const;
    /**
     * Go on with what saveConnectivity() has returned.
     *
     * @param context  a Context with a force on the same triangles
     * @param saved    the bytes
     */
    void restoreConnectivity(OpenMM::Context& context, const std::string& saved) const;
    /**
     * Get the derivative of the energy of all membrane forces of a Context with respect to a homogeneous strain of
     * positions and periodic box: with r + ε r for r and likewise for the box vectors it is ∂E/∂ε, kJ/mol, exact. It is
     * symmetric. Where no surface spans the box it is −Σ F ⊗ r; the kinetic part of a pressure is not in it, nor that
     * of other forces.
     *
     * @param context  the Context
     * @param groups   a bit for each force group that counts, as of Context::getState()
     * @return the nine elements, row by row
     */
    std::vector<double> getVirial(OpenMM::Context& context, int groups = -1) const;

protected:
    /**
     * @param type       the name of the class
     * @param triangles  the particle indices of the corners, three for each triangle
     */
    TriangulatedForce(const std::string& type, const std::vector<int>& triangles);

private:
    ConnectivityImpl& getConnectivityImpl(OpenMM::Context& context) const;

    std::vector<int> triangles;
};

/*
 * The classes are all in their headers, on top of the C functions that the library exports: whoever uses
 * them needs no other library than the plugin.
 */
#ifndef SWIG

inline TriangulatedForce::TriangulatedForce(const std::string& type, const std::vector<int>& triangles)
    : HelfrichForce(type) {
    addTriangles(triangles);
}

inline int TriangulatedForce::addTriangle(int particle1, int particle2, int particle3) {
    triangles.insert(triangles.end(), {particle1, particle2, particle3});
    return getNumTriangles() - 1;
}

inline void TriangulatedForce::addTriangles(const std::vector<int>& corners) {
    if (corners.size() % 3 != 0)
        fail("a list of " + std::to_string(corners.size()) + " corners is not made of triangles");
    triangles.insert(triangles.end(), corners.begin(), corners.end());
}

inline void TriangulatedForce::getTriangle(int index, int& particle1, int& particle2, int& particle3) const {
    if (index < 0 || index >= getNumTriangles())
        fail("there is no triangle " + std::to_string(index) + " among " + std::to_string(getNumTriangles()));
    particle1 = triangles[3 * index];
    particle2 = triangles[3 * index + 1];
    particle3 = triangles[3 * index + 2];
}

inline ConnectivityImpl& TriangulatedForce::getConnectivityImpl(OpenMM::Context& context) const {
    return dynamic_cast<ConnectivityImpl&>(getImplInContext(context));
}

inline std::vector<int> TriangulatedForce::getTrianglesInContext(OpenMM::Context& context) const {
    return getConnectivityImpl(context).getTrianglesInContext(getContextImpl(context));
}

inline void TriangulatedForce::setTrianglesInContext(OpenMM::Context& context, const std::vector<int>& corners) const {
    if (corners.size() % 3 != 0)
        fail("a list of " + std::to_string(corners.size()) + " corners is not made of triangles");
    getConnectivityImpl(context).setTrianglesInContext(getContextImpl(context), corners);
}

inline std::vector<int> TriangulatedForce::getPermutationInContext(OpenMM::Context& context) const {
    return getConnectivityImpl(context).getPermutationInContext(getContextImpl(context));
}

inline void TriangulatedForce::setPermutationInContext(OpenMM::Context& context,
                                                       const std::vector<int>& permutation) const {
    getConnectivityImpl(context).setPermutationInContext(getContextImpl(context), permutation);
}

inline std::string TriangulatedForce::saveConnectivity(OpenMM::Context& context) const {
    return getConnectivityImpl(context).saveConnectivity(getContextImpl(context));
}

inline void TriangulatedForce::restoreConnectivity(OpenMM::Context& context, const std::string& saved) const {
    getConnectivityImpl(context).restoreConnectivity(getContextImpl(context), saved);
}

inline std::vector<double> TriangulatedForce::getVirial(OpenMM::Context& context, int groups) const {
    return getConnectivityImpl(context).getVirial(getContextImpl(context), groups);
}

#endif /*SWIG*/

} // namespace HelfrichPlugin

#endif /*HELFRICH_TRIANGULATED_FORCE_H_*/
