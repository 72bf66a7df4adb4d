// Functions that the drivers have in half of single precision only (Vulkan allows an error of 4096 units in
// the last place for an arc tangent), or not at all in double precision.

const PI = 3.14159265358979323846;

// tan² of 22.5°.
const POLYNOMIAL_RANGE = 0.171572875253809902397;

// arctan(t) / t for t² = z ≤ POLYNOMIAL_RANGE, to 2e-18, as in src/mesh/geometry.rs.
fn arctan_over_argument(z: real) -> real {
    var sum = real(-0.017805397205419446);
    sum = real(0.03796525745386593) + z * sum;
    sum = real(-0.050351024566015520) + z * sum;
    sum = real(0.05846878297330872) + z * sum;
    sum = real(-0.06662951813629192) + z * sum;
    sum = real(0.07692045330902225) + z * sum;
    sum = real(-0.09090896809064027) + z * sum;
    sum = real(0.11111110744919658) + z * sum;
    sum = real(-0.14285714279250245) + z * sum;
    sum = real(0.19999999999940893) + z * sum;
    sum = real(-0.33333333333333120) + z * sum;
    return real(1.0) + z * sum;
}

// The angle of the vector (x, y), in (−π, π], for y or x different from zero.
fn angle_of(y: real, x: real) -> real {
    let smaller = min(abs(x), abs(y));
    let larger = max(abs(x), abs(y));
    // Below 45°, and brought below 22.5° where it is above.
    var t = smaller / larger;
    var angle = real(0.0);
    if t * t > real(POLYNOMIAL_RANGE) {
        t = (smaller - larger) / (smaller + larger);
        angle = real(0.25 * PI);
    }
    angle += t * arctan_over_argument(t * t);
    if abs(y) > abs(x) {
        angle = real(0.5 * PI) - angle;
    }
    if x < real(0.0) {
        angle = real(PI) - angle;
    }
    return select(angle, -angle, y < real(0.0));
}

// sin x and cos x for |x| ≤ π/2: Taylor's series, to 1e-17.
fn sine(x: real) -> real {
    let z = x * x;
    var sum = real(1.0);
    for (var n = 11u; n > 0u; n--) {
        sum = real(1.0) - z / real(2u * n * (2u * n + 1u)) * sum;
    }
    return x * sum;
}

fn cosine(x: real) -> real {
    let z = x * x;
    var sum = real(1.0);
    for (var n = 11u; n > 0u; n--) {
        sum = real(1.0) - z / real((2u * n - 1u) * 2u * n) * sum;
    }
    return sum;
}

// eˣ − 1 for 0 ≤ x ≤ 20: x = n ln 2 + r, and Taylor's series for |r| ≤ ½ ln 2.
fn exp_minus_one(x: real) -> real {
    let n = u32(x * real(1.44269504088896340736) + real(0.5));
    // ln 2 in two parts, of which the first has few enough digits for n times it to be exact.
    let r = (x - real(n) * real(0.693145751953125)) - real(n) * real(1.42860682030941723212e-6);
    var sum = real(1.0);
    for (var k = 14u; k > 1u; k--) {
        sum = real(1.0) + r / real(k) * sum;
    }
    let power = real(1u << n);
    return power * (r * sum) + (power - real(1.0));
}
