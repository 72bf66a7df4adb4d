#ifndef HELFRICH_LINE_TENSION_FORCE_H_
#define HELFRICH_LINE_TENSION_FORCE_H_

#include "MembraneForce.h"

namespace HelfrichPlugin {

/**
 * The tension of the line between domains of a membrane:
 *
 *     E = gamma L
 *
 * with the length L of the line that separates vertices of different domains. In a triangle with two corners in one
 * domain and the third in another it joins the middles of the two mixed sides, and in a triangle of three domains it
 * leads from the middles of all sides to the centroid. There may be any number of domains. BendingForce can have a
 * rigidity and a spontaneous curvature for each vertex, and so for each domain.
 *
 * The smooth counterpart is F. Juelicher and R. Lipowsky, Phys. Rev. Lett. 70, 2964 (1993),
 * doi:10.1103/PhysRevLett.70.2964. A line through a mesh goes in zigzag and is longer than a smooth one, however fine
 * the mesh is: on equilateral triangles by 1 along their edges, 2/sqrt(3) at 30 degrees to these and 2 sqrt(3)/pi
 * = 1.103 on average, on random meshes by 1.107. So gamma is to be the energy of a smooth line by length, divided by
 * this.
 *
 * Domains belong to the vertices: bond flips take a vertex along with its domain, so that domains mix and sort on a
 * membrane that flows. With a MonteCarloDomainSwap neighbours exchange them.
 */
class LineTensionForce : public MembraneForce {
public:
    /**
     * @param triangles  the particle indices of the corners, three for each triangle
     * @param tension    the energy gamma per length, kJ/mol/nm; below zero, domains mix
     * @param domains    the number of each vertex' domain, in ascending order of particle index
     */
    LineTensionForce(const std::vector<int>& triangles, double tension, const std::vector<int>& domains)
        : MembraneForce("LineTensionForce", triangles, {tension}) {
        setDomains(domains);
    }
    /**
     * Get the energy per length, kJ/mol/nm.
     */
    double getTension() const {
        return getParameterValue("tension");
    }
    /**
     * Set the energy per length, kJ/mol/nm.
     */
    void setTension(double tension) {
        setParameterValue("tension", tension);
    }
    /**
     * Get the number of each vertex' domain, in ascending order of particle index.
     */
    std::vector<int> getDomains() const {
        return std::vector<int>(getVertexNumbers().begin(), getVertexNumbers().end());
    }
    /**
     * Set the number of each vertex' domain. updateParametersInContext() tells existing Contexts.
     *
     * @param domains  in ascending order of particle index
     */
    void setDomains(const std::vector<int>& domains) {
        setVertexNumbers(std::vector<double>(domains.begin(), domains.end()));
    }
    /**
     * Get the number of each vertex' domain as it is in a Context now: MonteCarloDomainSwap lets neighbours exchange
     * them.
     *
     * @param context  the Context
     */
    std::vector<int> getDomainsInContext(OpenMM::Context& context) const {
        std::vector<double> numbers = dynamic_cast<const VertexNumbersImpl&>(getImplInContext(context))
                                          .getVertexNumbersInContext(getContextImpl(context));
        return std::vector<int>(numbers.begin(), numbers.end());
    }
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_LINE_TENSION_FORCE_H_*/
