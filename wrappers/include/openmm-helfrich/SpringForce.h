#ifndef HELFRICH_SPRING_FORCE_H_
#define HELFRICH_SPRING_FORCE_H_

#include "MembraneForce.h"

namespace HelfrichPlugin {

/**
 * Springs along the edges, a network such as the spectrin skeleton of a red blood cell:
 *
 *     E = sum over edges of f(l)
 *
 * with the length l of an edge. Each spring has its minimum, f = 0, at the length l0 that its edge has in the reference,
 * and there the stiffness k = f'' that all have. A net of equilateral triangles without tension has the shear modulus
 * sqrt(3)/4 k and the area modulus sqrt(3)/2 k.
 *
 * The reference gives each vertex a position, so that an edge which bond flips make is as long at rest as its ends are
 * apart there.
 */
class SpringForce : public MembraneForce {
public:
    /**
     * The functions f of the length.
     */
    enum Form {
        /**
         * f = 1/2 k (l - l0)^2.
         */
        Harmonic = 0,
        /**
         * f = A [g(x) - g(x0)] + p (1/l - 1/l0), a worm-like chain with g(x) = (3 x^2 - 2 x^3)/(1 - x), x = l/lmax, and a
         * repulsion, of which l0 and k determine A and p: D. A. Fedosov, B. Caswell and G. E. Karniadakis, Biophys. J. 98,
         * 2215 (2010), doi:10.1016/j.bpj.2010.02.002, with m = 2, p = k_p and A = kBT lmax/(4p) there. An edge of
         * length lmax or more is an error that names it.
         */
        WLCPower = 1
    };
    /**
     * @param triangles  the particle indices of the corners, three for each triangle
     * @param stiffness  the stiffness k = f''(l0), kJ/mol/nm^2, zero or above
     * @param reference  the positions of the vertices at rest, nm, three coordinates for each, in ascending order of
     *                   particle index
     * @param ratio      the length at rest as a share of the longest, l0/lmax, above zero and below one; of WLCPower
     *                   only
     * @param form       the function f
     */
    SpringForce(const std::vector<int>& triangles, double stiffness, const std::vector<double>& reference,
                double ratio = 1 / 2.2, Form form = Harmonic)
        : MembraneForce("SpringForce", triangles, {stiffness, ratio}, form) {
        setReference(reference);
    }
    /**
     * Get the stiffness k of all springs at rest, kJ/mol/nm^2.
     */
    double getStiffness() const {
        return getParameterValue("stiffness");
    }
    /**
     * Set the stiffness k of all springs at rest, kJ/mol/nm^2, zero or above.
     */
    void setStiffness(double stiffness) {
        setParameterValue("stiffness", stiffness);
    }
    /**
     * Get the length at rest as a share of the longest, l0/lmax.
     */
    double getRatio() const {
        return getParameterValue("ratio");
    }
    /**
     * Set the length at rest as a share of the longest, l0/lmax, above zero and below one.
     */
    void setRatio(double ratio) {
        setParameterValue("ratio", ratio);
    }
    /**
     * Get the function of the length.
     */
    Form getForm() const {
        return (Form) MembraneForce::getForm();
    }
    /**
     * Set the function of the length. updateParametersInContext() tells existing Contexts.
     */
    void setForm(Form form) {
        MembraneForce::setForm(form);
    }
    /**
     * Get the positions of the vertices at rest, nm, three coordinates for each.
     */
    const std::vector<double>& getReference() const {
        return getVertexNumbers();
    }
    /**
     * Set the positions of the vertices at rest; setReferenceBox() says in which periodic box they are.
     *
     * @param positions  nm, three coordinates for each, in ascending order of particle index
     */
    void setReference(const std::vector<double>& positions) {
        setVertexNumbers(positions);
    }
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_SPRING_FORCE_H_*/
