"""Where a number stands in the compiled kernels' arrays: state columns, parameters, switches."""

import numpy as np
from numpy.typing import NDArray

IntArray = NDArray[np.int64]

# columns of a state, one row per node (position, velocity) and per element between node i and i + 1
X, Y, Z, VX, VY, VZ, AZZ, ARR, CHARGE, VOLUME, MX, MY, MZ, TEMP, LABEL, SPIN = range(16)
COLUMNS = 16  # LABEL: the element's volume when it left the nozzle; SPIN: its turning about its own axis, 1/s

# parameters, SI
(
    RHO,
    SURFACE,
    MODULUS,
    THETA,
    SOLVENT,
    EXTENT,  # FENE-P: L^2
    MOBILITY,  # Giesekus
    YIELD,
    CONSISTENCY,
    INDEX,
    FLOW,
    RADIUS,
    AZZ_IN,
    ARR_IN,
    COMPLIANCE,
    TENSION_IN,
    GRAVITY,
    FIELD,
    VOLTAGE,
    GAP,
    TIP,
    LOG_LENGTH,
    CURRENT,
    CONDUCTIVITY,
    CHARGE_DENSITY,
    POTENTIAL_IN,
    FEED_COUNT,  # straight lines of charge upstream, all ending at the nozzle
    CONE,  # length from the needle over which the local logarithm gives way to the long reach of the charge
    AMPLITUDE,
    OMEGA,
    PHASE,
    RAMP,
    AIR_DENSITY,
    AIR_VISCOSITY,
    DRAG_XI,
    DRAG_ZETA,
    DRAG_ETA,
    AIR_X,
    AIR_Y,
    AIR_Z,
    SIDE_FIELD,
    SIDE_OMEGA,
    B_X,
    B_Y,
    B_Z,
    NOISE,
    BEND_VISCOSITY,
    FRACTION,  # polymer volume fraction at the nozzle
    DRY_B,
    DRY_M,
    DRY_N,
    VAPOUR_DIFFUSION,
    VAPOUR_EQ,  # vapour concentration over the liquid's density at the pure solvent's surface
    VAPOUR_FAR,
    INTERACTION,  # Flory-Huggins chi
    SHERWOOD_LEAST,
    AIR_CONDUCTIVITY,
    PRANDTL,
    HEAT_CAPACITY,
    LATENT,
    LATENT_SLOPE,  # M L/R: how the vapour pressure follows the temperature
    ACTIVATION,  # E/R of viscosity and relaxation time
    AIR_TEMPERATURE,
    START_TEMPERATURE,
    COLLECTOR_SPEED,
    DRUM_RADIUS,
    OUTFLOW,  # where a cut jet's elements leave the computation
    LOAD_RAMP,
    LONGEST,  # length beyond which an element is split in two; 0: never
    COUPLING,  # 1/(4 pi eps0) times the ramp of the loads; set by the kernels
    NEEDLE_AT,  # x of the needle's tip: 0, or upstream of where the chain starts
    SETTLE,  # time over which the charge goes from the local logarithm to the whole thread
    SETTLED,  # how far it has; set by the kernels
) = range(73)
FEED_FIRST = 73  # their lengths and line charges in turn
FEEDS = 12
CROSS = FEED_FIRST + 2 * FEEDS  # weight of the flow across in the transfer to the air
TURN = CROSS + 1  # angle between neighbours beyond which the longer is split in two; 0: never
PARAMETERS = TURN + 1

# switches
(
    LAW,
    REPULSION,
    PRESSURE,  # Maxwell's radial pressure: da/dl terms of the energy
    NEAR,
    BALANCE,
    INLET,
    FIELD_KIND,
    SIDE_KIND,
    IMAGE,
    BENDING,
    AIR,
    LIFT,
    TREE,
    COLLECTOR,
    DRYING,
    END,
    EXPLICIT_SOLVENT,
    SEED,
) = range(18)
SWITCHES = 18

CONFORMATION, LINEAR_MAXWELL, HERSCHEL_BULKLEY = range(3)
NO_REPULSION, LOCAL, EXACT, HYBRID = range(4)
FROZEN, GIVEN_CURRENT, GIVEN_POTENTIAL = range(3)
EXTRAPOLATED, PRESCRIBED = range(2)
UNIFORM, HYPERBOLOID, AXIS_TABLE = range(3)
NO_SIDE, ROTATING, SQUARE = range(3)
NO_BENDING, VISCOUS, ELASTIC = range(3)
NO_COLLECTOR, PLATE, BELT, DRUM = range(4)
FREE_END, TRACTION, CLAMPED = range(3)

# rows of the elements' work array
LENGTH, TX, TY, TZ, AREA, RATE, TENSION, POLYMER, G_HERE, THETA_HERE, SOLVENT_HERE, SHARE = range(12)
WORK = 12  # SHARE: part of the charge that reaches far

COULOMB = 8.9875517873681764e9
"""1/(4 pi eps0), N m2/C2."""

# columns of a landed element
(
    D_TIME,
    D_FRONT,
    D_X0,
    D_Y0,
    D_Z0,
    D_X1,
    D_Y1,
    D_Z1,
    D_FLIGHT,
    D_VOLUME,
    D_LABEL_VOLUME,
    D_CHARGE,
    D_VX,
    D_VY,
    D_VZ,
    D_LABEL,
) = range(16)
DEPOSITS = 16

CLOCK = 14

# tables: row 0 holds how many samples of the end, of the field, of rings; rows 1 to 5 the samples
ENDS, FIELDS, RINGS = range(3)
RINGS_FIRST = 6  # x and radius of the needle's rings, then the inverse of their potentials
AIR_FIRST = 100  # rows x, speed, half width of the air; beyond them the other jets' charges
# what an integration stopped for
DONE, FULL, BROKEN, STALLED, PAUSED = range(5)
