"""Reference curves of the sand law, by a second way.

An integration of the law of docs/model.md, section 7, that shares neither code nor method with
the program: on a monotonic path the state stays on the loading surface, so that stress, strain
and eps_q are an ordinary differential equation in the controlled strain. SciPy's DOP853 integrates
it, and every slope of the surface is a complex-step derivative of q - q_hat itself (the formulas
for C, E, F and T are not used). Nothing returns the state to the surface: how far it has drifted
from it is an error measure, and is printed.

    python3 reference_curves.py          rewrites the curves of NEW, in this script's folder
    python3 reference_curves.py --check  integrates all curves, prints the misfit to the files

Units are kPa; stresses and strains are compression positive, strains logarithmic. All paths have
fixed principal axes, so tensors are three principal values: axial, lateral, out of plane.
"""
import argparse
import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Optional

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

P_A = 101.0                  # kPa, reference pressure
ROWS = 151
FIRST_STRAIN = 1e-9          # the straight path away from the isotropic state ends here
COLUMNS = ("axial_strain,deviatoric_stress_kPa,mean_stress_kPa,volumetric_strain,"
           "void_ratio,lode_angle_deg")
FOLDER = Path(__file__).resolve().parent


@dataclass(frozen=True)
class Sand:
    """Constants of the law under the paper's names; the defaults are Stockton Beach sand."""
    e0: float = 0.6
    G0: float = 250.0
    kappa: float = 0.012
    Mc: float = 1.24
    c: float = 0.75
    e_Gamma: float = 0.925
    lambda_c: float = 0.037
    xi: Optional[float] = None      # None: critical line straight in e - ln p
    d0: float = 0.45
    m: float = 4.1
    eps_r: float = 0.06
    softening: str = "normalized"   # or plain, explicit
    dilatancy: str = "printed"      # or lode
    bulk: str = "log"               # or power, poisson
    bulk_xi: float = 0.7            # exponent of bulk = power
    poisson: float = 0.2            # ratio of bulk = poisson
    cohesion_shift: float = 0.0     # p_c in p* = p + p_c, kPa
    psi_cap: float = 0.15


@dataclass(frozen=True)
class Curve:
    """What one file holds: the sand, the test, its initial pressure and its last strain."""
    sand: Sand
    test: str
    pressure: float
    strain_end: float


# ---- the law ------------------------------------------------------------------------------

def shear_modulus(sand, ps):
    """G, (15); ps is p*."""
    return sand.G0 * (2.973 - sand.e0)**2 / (1 + sand.e0) * np.sqrt(ps * P_A)


def bulk_modulus(sand, ps):
    """K: (24) for the straight line, in its power form, or from Poisson's ratio."""
    if sand.bulk == "log":
        return (1 + sand.e0) * ps / sand.kappa
    if sand.bulk == "power":
        return (1 + sand.e0) * ps / (sand.kappa * sand.bulk_xi) * (P_A / ps)**sand.bulk_xi
    if sand.bulk == "poisson":
        nu = sand.poisson
        return 2 * shear_modulus(sand, ps) * (1 + nu) / (3 * (1 - 2 * nu))
    raise ValueError(sand.bulk)


def critical_void_ratio(sand, ps):
    """e_c, (19): straight in e - ln p, or the power of xi."""
    if sand.xi is None:
        return sand.e_Gamma - sand.lambda_c * np.log(ps)
    return sand.e_Gamma - sand.lambda_c * (ps / P_A)**sand.xi


def lode_shape(sand, sin3t):
    """g(theta), (16), in the form that is regular at sin 3theta = 0."""
    c = sand.c
    root = np.sqrt((1 + c * c)**2 + 4 * c * (1 - c * c) * sin3t)
    return 2 * c * (1 + c) / (root + 1 + c * c)


def state_dilatancy(sand, ps, e):
    """A, (18), with psi capped."""
    psi = e - critical_void_ratio(sand, ps)
    psi = np.where(np.real(psi) < sand.psi_cap, psi, sand.psi_cap)
    return sand.d0 * np.exp(sand.m * psi)


def dilatancy_parts(sand, ps, e, sin3t):
    """(alpha, beta) of D = alpha - beta eta, (17), as printed or times g."""
    g = lode_shape(sand, sin3t)
    A = state_dilatancy(sand, ps, e)
    if sand.dilatancy == "printed":
        return A, sand.d0 / (sand.Mc * g)
    if sand.dilatancy == "lode":
        return g * A, sand.d0 / sand.Mc + 0 * g
    raise ValueError(sand.dilatancy)


def softening(sand, eps_q):
    """f(eps_q): x exp(1 - x), or x exp(-x) if plain."""
    x = eps_q / sand.eps_r
    return x * np.exp((0 if sand.softening == "plain" else 1) - x)


def q_hat(sand, ps, e, eps_q, sin3t):
    """Right side of (12), solved for q; if explicit, with h (13, 14) in D instead of q."""
    alpha, beta = dilatancy_parts(sand, ps, e, sin3t)
    M = sand.Mc * lode_shape(sand, sin3t)
    h = eps_q / (1 / (3 * shear_modulus(sand, ps)) + eps_q / (M * ps))
    f = softening(sand, eps_q)
    if sand.softening == "explicit":
        return h * (1 + f * beta) - f * alpha * ps
    return (h - f * alpha * ps) / (1 - f * beta)


def invariants(sigma):
    """p, s, q and sin 3theta, which is -1 in compression."""
    p = sum(sigma) / 3
    s = sigma - p
    q = np.sqrt(1.5 * sum(s * s))
    return p, s, q, -13.5 * s[0] * s[1] * s[2] / q**3


def overstress(sand, z):
    """phi = q - q_hat of z = (three stresses, e, eps_q)."""
    p, _, q, sin3t = invariants(z[:3])
    return q - q_hat(sand, p + sand.cohesion_shift, z[3], z[4], sin3t)


def gradient(sand, z):
    """d phi/dz by complex steps, exact to rounding."""
    step = 1e-20
    return overstress(sand, z[:, None] + 1j * step * np.eye(5)).imag / step


# ---- response to a strain rate ------------------------------------------------------------

class Tangent:
    """The law linearised at a state on the surface: moduli, flow, slopes of phi."""

    def __init__(self, sand, sigma, e, eps_q):
        p, s, q, sin3t = invariants(sigma)
        ps = p + sand.cohesion_shift
        alpha, beta = dilatancy_parts(sand, ps, e, sin3t)
        slope = gradient(sand, np.array([*sigma, e, eps_q]))
        self.K, self.G = bulk_modulus(sand, ps), shear_modulus(sand, ps)
        self.e, self.F = e, -slope[4]
        self.slope_sigma, self.slope_e = slope[:3], slope[3]
        self.radial = s / q     # sqrt(2/3) n
        # stress that unit deps_q^p relaxes: K D to p and 2G sqrt(3/2) n to s
        self.relaxed = self.K * (alpha - beta * q / ps) + 3 * self.G * self.radial

    def elastic(self, d):
        """Stress rate without flow."""
        volume = d.sum()
        return self.K * volume + 2 * self.G * (d - volume / 3)

    def deps_q(self, d):
        """sqrt(2/3) n : de."""
        return self.radial @ (d - d.sum() / 3)

    def excess(self, d):
        """X: how fast an elastic step leaves the surface at constant eps_q."""
        return self.slope_sigma @ self.elastic(d) - self.slope_e * (1 + self.e) * d.sum()

    def flow(self, d, hardening):
        """lambda, (23), with (1) or without (0) growth of eps_q."""
        growth = self.F * self.deps_q(d) * hardening
        return (self.excess(d) - growth) / (self.slope_sigma @ self.relaxed)

    def plastic(self, d, hardening):
        """Stress rate with flow."""
        return self.elastic(d) - self.flow(d, hardening) * self.relaxed


# Strain rates u + alpha v per unit of the controlled strain; where v is given, alpha is what
# keeps the lateral stress. In simple shear the axes are those of the strain, 45 degrees off.
TESTS = {
    "triaxial": ((1, 0, 0), (0, 1, 1)),
    "plane_strain": ((1, 0, 0), (0, 1, 0)),
    "simple_shear_constant_volume": ((0.5, -0.5, 0), None),
    "oedometer": ((1, 0, 0), None),
}


def test_rates(curve):
    """u and v of a curve's test; u has the sign of the last strain (extension: negative)."""
    u, v = TESTS[curve.test]
    u = math.copysign(1, curve.strain_end) * np.array(u, float)
    return u, None if v is None else np.array(v, float)


def controlled(u, v, stress_rate):
    """The strain rate under a stress response that is linear in it."""
    if v is None:
        return u
    return u - v * (stress_rate(u)[1] / stress_rate(v)[1])


def respond(tangent, u, v):
    """Rates of strain, stress and eps_q: plastic or neutral loading, never unloading."""
    d = controlled(u, v, lambda r: tangent.plastic(r, 1))
    if tangent.deps_q(d) > 0 and tangent.flow(d, 1) > 0:
        return d, tangent.plastic(d, 1), tangent.deps_q(d)
    d = controlled(u, v, lambda r: tangent.plastic(r, 0))
    if tangent.deps_q(d) <= 0 and tangent.flow(d, 0) > 0:
        return d, tangent.plastic(d, 0), 0.0
    d = controlled(u, v, tangent.elastic)
    if tangent.excess(d) > 0 and tangent.flow(d, 1) <= 0:     # neutral loading
        return d, tangent.elastic(d), tangent.excess(d) / tangent.F
    raise ArithmeticError("the path unloads")


# ---- a whole test -------------------------------------------------------------------------

def initial_stress_rate(sand, pressure, d):
    """Stress rate at q = eps_q = 0, n being the direction of de, and deps_q.

    C, E and T vanish there: dq = F deps_q, lambda = (1 - F/3G) deps_q.
    """
    ps = pressure + sand.cohesion_shift
    K, G = bulk_modulus(sand, ps), shear_modulus(sand, ps)
    deviator = d - d.sum() / 3
    deps_q = math.sqrt(2 / 3 * deviator @ deviator)
    sin3t = invariants(d)[3]
    D = dilatancy_parts(sand, ps, sand.e0, sin3t)[0]
    F = q_hat(sand, ps, sand.e0, 1e-20j, sin3t).imag / 1e-20
    volume = d.sum() - D * (1 - F / (3 * G)) * deps_q
    return K * volume + 2 / 3 * F * deviator, deps_q


def first_state(curve, u, v):
    """Stresses, strains and eps_q a first small strain away from the isotropic state."""
    def lateral(alpha):
        return initial_stress_rate(curve.sand, curve.pressure, u + alpha * v)[0][1]

    # alpha = 1 (in extension -1) is isotropic contraction, the other end dilation
    d = u if v is None else u + v * brentq(lateral, -0.999, 0.999, xtol=1e-14)
    stress_rate, deps_q = initial_stress_rate(curve.sand, curve.pressure, d)
    rates = np.array([*stress_rate, *d, deps_q])
    return np.array([curve.pressure] * 3 + [0.0] * 4) + FIRST_STRAIN * rates


def void_ratio(sand, volumetric_strain):
    """e after a logarithmic volumetric strain."""
    return (1 + sand.e0) * np.exp(-volumetric_strain) - 1


def integrate(curve, rtol=1e-10, method="DOP853"):
    """Strains of the rows and states (stresses, strains, eps_q) at them, the first row left out.

    Left to itself, an explicit method takes steps at its limit of stability in simple shear and
    amplifies rounding in the Lode angle, hence the largest step.
    """
    u, v = test_rates(curve)

    def rates(_, y):
        e = void_ratio(curve.sand, y[3:6].sum())
        d, stress_rate, deps_q = respond(Tangent(curve.sand, y[:3], e, y[6]), u, v)
        return np.array([*stress_rate, *d, deps_q])

    strains = np.linspace(0, abs(curve.strain_end), ROWS)[1:]
    atol = rtol * np.array([curve.pressure] * 3 + [1e-3] * 4)
    result = solve_ivp(rates, (FIRST_STRAIN, strains[-1]), first_state(curve, u, v), method,
                       strains, rtol=rtol, atol=atol, first_step=FIRST_STRAIN,
                       max_step=strains[0] / 4)
    if not result.success:
        raise ArithmeticError(result.message)
    return math.copysign(1, curve.strain_end) * strains, result.y.T


def table(curve, strains, states):
    """The columns of a file."""
    rows = [(0, 0, curve.pressure, 0, curve.sand.e0, 0)]    # no deviator, no Lode angle
    for strain, y in zip(strains, states):
        p, _, q, sin3t = invariants(y[:3])
        volume = y[3:6].sum()
        theta = math.degrees(math.asin(min(1, max(-1, sin3t)))) / 3
        rows.append((strain, q, p, volume, void_ratio(curve.sand, volume), theta))
    return np.array(rows)


def drift(curve, states):
    """Largest |q - q_hat|/p* at the rows."""
    def at(y):
        e = void_ratio(curve.sand, y[3:6].sum())
        phi = overstress(curve.sand, np.array([*y[:3], e, y[6]]))
        return abs(phi) / (y[:3].mean() + curve.sand.cohesion_shift)
    return max(at(y) for y in states)


def peak_friction_angle(states):
    """Largest asin((s1 - s3)/(s1 + s3)), in degrees."""
    high, low = states[:, :3].max(axis=1), states[:, :3].min(axis=1)
    return math.degrees(np.arcsin((high - low) / (high + low)).max())


# ---- the curves ---------------------------------------------------------------------------

STOCKTON = Sand()
LODE = replace(STOCKTON, dilatancy="lode", c=0.7075)
EXPLICIT = replace(LODE, softening="explicit")
POISSON = replace(LODE, bulk="poisson", poisson=0.2)
TOYOURA = Sand(G0=125, Mc=1.25, c=0.712, e_Gamma=0.934, lambda_c=0.019, xi=0.7, d0=0.6, m=3,
               eps_r=0.05, dilatancy="lode", bulk="poisson", poisson=0.2)


def curve(sand, e0, test, pressure, strain_end, **changes):
    """One entry of the tables below."""
    return Curve(replace(sand, e0=e0, **changes), test, pressure, strain_end)


SHEAR = "simple_shear_constant_volume"

# Made by another integrator (relative tolerance 1e-8); this script only compares.
GIVEN = {
    "triaxial_p150_e0.551": curve(STOCKTON, 0.551, "triaxial", 150, 0.3),
    "triaxial_p150_e0.64": curve(STOCKTON, 0.64, "triaxial", 150, 0.3),
    "triaxial_p150_e0.72": curve(STOCKTON, 0.72, "triaxial", 150, 0.3),
    "triaxial_p500_e0.574": curve(STOCKTON, 0.574, "triaxial", 500, 0.3),
    "triaxial_p500_e0.64": curve(STOCKTON, 0.64, "triaxial", 500, 0.3),
    "triaxial_p500_e0.72": curve(STOCKTON, 0.72, "triaxial", 500, 0.3),
    "plane_strain_p50_e0.524": curve(STOCKTON, 0.524, "plane_strain", 50, 0.3),
    "plane_strain_p400_e0.581": curve(STOCKTON, 0.581, "plane_strain", 400, 0.3),
    "simple_shear_constant_volume_p100_e0.657": curve(STOCKTON, 0.657, SHEAR, 100, 0.6),
    "oedometer_p5_e0.657_cohesion1.67":
        curve(STOCKTON, 0.657, "oedometer", 5, 0.03, cohesion_shift=1.67),
}

# Made by this script.
NEW = {
    "lode_plane_strain_p5_e0.524": curve(LODE, 0.524, "plane_strain", 5, 0.3),
    "lode_plane_strain_p50_e0.524": curve(LODE, 0.524, "plane_strain", 50, 0.3),
    "lode_plane_strain_p400_e0.581": curve(LODE, 0.581, "plane_strain", 400, 0.3),
    "lode_triaxial_extension_p100_e0.6": curve(LODE, 0.6, "triaxial", 100, -0.3),
    "power_triaxial_p150_e0.551":
        curve(STOCKTON, 0.551, "triaxial", 150, 0.3, bulk="power", bulk_xi=0.7),
    "power_lode_plane_strain_p20_e0.6":
        curve(LODE, 0.6, "plane_strain", 20, 0.3, bulk="power", bulk_xi=0.3),
    "poisson_lode_simple_shear_constant_volume_p100_e0.657":
        curve(POISSON, 0.657, SHEAR, 100, 0.6),
    "poisson_lode_plane_strain_p50_e0.524": curve(POISSON, 0.524, "plane_strain", 50, 0.3),
    "power_line_lode_plane_strain_p98_e0.7": curve(TOYOURA, 0.7, "plane_strain", 98, 0.3),
    "explicit_lode_plane_strain_p50_e0.524": curve(EXPLICIT, 0.524, "plane_strain", 50, 0.3),
}


def misfit(rows, reference):
    """Largest differences: q and p relative to peak q, volumetric strain, void ratio, angle."""
    difference = np.abs(rows - reference).max(axis=0)
    peak = reference[:, 1].max()
    return difference[1] / peak, difference[2] / peak, *difference[3:]


def check():
    """Print how far the files are from the integration."""
    print("misfit of      q/peak   p/peak   volume   e        angle    drift    peak friction")
    for name, one in {**GIVEN, **NEW}.items():
        strains, states = integrate(one)
        reference = np.loadtxt(FOLDER / f"{name}.csv", delimiter=",", skiprows=1)
        values = (*misfit(table(one, strains, states), reference), drift(one, states))
        numbers = " ".join(f"{value:8.1e}" for value in values)
        print(f"{name}\n             {numbers} {peak_friction_angle(states):8.2f} deg")


def write():
    """Rewrite the files of NEW."""
    for name, one in NEW.items():
        rows = table(one, *integrate(one)).round(10) + 0.0     # + 0: no negative zeros
        np.savetxt(FOLDER / f"{name}.csv", rows, "%.8g", ",", header=COLUMNS, comments="")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--check", action="store_true", help="compare with the files instead")
    (check if parser.parse_args().check else write)()
