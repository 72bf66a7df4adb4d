#ifndef HELFRICH_DIHEDRAL_FORCE_H_
#define HELFRICH_DIHEDRAL_FORCE_H_

#include "MembraneForce.h"

namespace HelfrichPlugin {

/**
 * Stiff hinges between neighbouring triangles:
 *
 *     E = K sum over edges of f(phi - phi0)
 *
 * with phi the angle between the normals of the two triangles of an edge, 0 when flat and positive at a convex edge,
 * and phi0 the angle at rest. Unlike BendingForce its effect depends on the mesh. K and phi0 can be given for each edge
 * of its own; edges are in lexicographic order of the particles at their ends, the lower one first (in Python
 * Mesh.edges), those on borders among them, which have no angle and no energy. Such values do not follow bond flips,
 * which are refused then.
 *
 * Sources: (B5) and the potential of fourth order of Farnudi, Ejtehadi and Everaers, Phys. Rev. E 108, 015301 (2023),
 * doi:10.1103/PhysRevE.108.015301. Angles at rest: Kantor and Nelson, Phys. Rev. Lett. 58, 2774 (1987),
 * doi:10.1103/PhysRevLett.58.2774; for red cells (6) of Fedosov, Caswell and Karniadakis, Biophys. J. 98, 2215 (2010),
 * doi:10.1016/j.bpj.2010.02.002, with the form Cosine.
 */
class DihedralForce : public MembraneForce {
public:
    /**
     * The functions of the angle x = phi - phi0, brought into (-pi, pi], with c = 1 - cos x.
     */
    enum Form {
        /**
         * f = c^2, about x^4 / 4: the paper's potential (VCM smoothTheta4).
         */
        Quartic = 0,
        /**
         * f = c, about x^2 / 2: Kantor and Nelson (B5) (VCM cosine).
         */
        Cosine = 1,
        /**
         * f = 1/2 (exp(2c) - 1) (VCM exp).
         */
        Exp = 2,
        /**
         * f = 0.04 (exp(10c) - 1) (VCM smoothExp).
         */
        SmoothExp = 3,
        /**
         * f = 1/2 (exp(2c) - 1 - x^2) (VCM smoothExp46).
         */
        SmoothExp46 = 4
    };
    /**
     * @param triangles  the particle indices of the corners, three for each triangle
     * @param stiffness  the stiffness K, kJ/mol, zero or above
     * @param form       the function f
     * @param restAngle  the angle phi0 at rest, from -pi to pi, radians
     */
    DihedralForce(const std::vector<int>& triangles, double stiffness, Form form = Quartic, double restAngle = 0)
        : MembraneForce("DihedralForce", triangles, {stiffness, restAngle}, form) {
    }
    /**
     * Get the stiffness K, kJ/mol.
     */
    double getStiffness() const {
        return getParameterValue("stiffness");
    }
    /**
     * Set the stiffness K, kJ/mol, zero or above.
     * Values of single edges are given up.
     */
    void setStiffness(double stiffness) {
        setParameterValue("stiffness", stiffness);
    }
    /**
     * Get the angle phi0 at rest.
     */
    double getRestAngle() const {
        return getParameterValue("restAngle");
    }
    /**
     * Set the angle phi0 at rest, from -pi to pi, positive for convex edges.
     * Values of single edges are given up.
     */
    void setRestAngle(double restAngle) {
        setParameterValue("restAngle", restAngle);
    }
    /**
     * Get the stiffness of each edge, kJ/mol; empty if all have the same.
     */
    const std::vector<double>& getEdgeStiffness() const {
        return getElementValues("stiffness");
    }
    /**
     * Give each edge its own stiffness, which replaces the scalar.
     *
     * @param values  one for each edge, in lexicographic order, kJ/mol; empty to go back
     */
    void setEdgeStiffness(const std::vector<double>& values) {
        setElementValues("stiffness", values);
    }
    /**
     * Get the angle at rest of each edge; empty if all have the same.
     */
    const std::vector<double>& getEdgeRestAngle() const {
        return getElementValues("restAngle");
    }
    /**
     * Give each edge its own angle at rest, which replaces the scalar.
     *
     * @param values  one for each edge, in lexicographic order; empty to go back
     */
    void setEdgeRestAngle(const std::vector<double>& values) {
        setElementValues("restAngle", values);
    }
    /**
     * Get the function of the angle.
     */
    Form getForm() const {
        return (Form) MembraneForce::getForm();
    }
    /**
     * Set the function of the angle. updateParametersInContext() tells existing Contexts.
     */
    void setForm(Form form) {
        MembraneForce::setForm(form);
    }
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_DIHEDRAL_FORCE_H_*/
