// Sums over a workgroup, as trees of fixed shape: the same bits every time. The groups are added
// up in order: by the host in double precision, or by OpenMM's platforms in theirs.

var<workgroup> shares: array<real, GROUP_SIZE>;

// The sum of what the members of the group give; every member must call it, the first one gets it.
fn sum_of_group(share: real, lane: u32) -> real {
    workgroupBarrier();
    shares[lane] = share;
    for (var half = GROUP_SIZE / 2u; half > 0u; half /= 2u) {
        workgroupBarrier();
        if lane < half {
            shares[lane] += shares[lane + half];
        }
    }
    return shares[lane];
}

// Store the sums of a term over a group; all of its members must call it.
fn store_sums(term: u32, first: u32, contribution: Contribution, lane: u32, group: u32, groups: u32) {
    let energy = sum_of_group(contribution.energy, lane);
    if lane == 0u && group < groups {
        results[first + group] = energy;
    }
    if (frame.terms[term].needs & DERIVATIVES) == 0u {
        return;
    }
    for (var k = 0u; k < PARAMETERS; k++) {
        let derivative = sum_of_group(contribution.by_parameter[k], lane);
        if lane == 0u && group < groups {
            results[first + (k + 1u) * groups + group] = derivative;
        }
    }
}
