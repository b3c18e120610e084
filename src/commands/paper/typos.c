// Where does the paper not mean what it prints?
//
// Each reading was found by recomputing the paper's own numbers; what stayed a guess says so.
#include "commands/paper/paper.h"

const Typo TYPOS[] = {
    {TYPO_TABLES_7_8, "Table V", "input speed 1000 rad/sec",
     "1000 rpm = 104.7198 rad/s, crank turning clockwise",
     "the ideal rows of Tables VII and VIII come out so; clockwise the signs of omega change, "
     "those "
     "of alpha do not"},
    {TYPO_TABLES_7_8, "Table VI", "moments of inertia in mm^4",
     "kg mm^2, about the link's centre of mass, which sits at mid-link",
     "as kg mm^2 they have the size of m l^2 / 12 of each link"},
    {TYPO_TABLE_2, "section IV.A", "maximum clearance 42 micron",
     "Table IV gives 10.015 - 9.986 = 0.029 mm in diameter, 14.5 micron in radius",
     "Table II needs 0.042 mm; contact runs here use 14.5 micron"},
    {TYPO_TABLE_2, "Eq. (9)", "force exponent e = 1.5", "e = 1",
     "every cell of Table II comes out with 1; with 1.5 each is 4.9 times smaller"},
    {TYPO_TABLES_7_8, "Table VIII", "POISSON, coupler, maximum 74069000", "most likely 7406900",
     "a guess: its neighbours are 7.1e6 to 1.0e7; never a target"},
    {TYPO_TABLES_7_8, "section IV.B", "16.72 % variation in angular acceleration of coupler",
     "in angular velocity of the follower", "94.018 / 80.553 is 1.1672"},
    {TYPO_TABLE_3, "section V", "mutual approach 0.02 micron at 100 rpm, 0.4 micron at 1500 rpm",
     "0.0090 and 0.333 micron", "its own Table III"},
    {TYPO_MODEL, "section IV.A", "material in Table IV, linkage in Table V, tolerances in Table VI",
     "Tables V, VI and IV", "the tables' own headings"},
    {TYPO_MODEL, "Eq. (6)", "D = 3 K (1 - e^2) delta_n / (4 delta)",
     "Lankarani and Nikravesh: F = K d^n (1 + 3 (1 - e^2) / 4 d' / d'_0)",
     "the printed form lacks d^n and the initial impact speed"},
    {TYPO_MODEL, "Eq. (3)", "two spheres", "a sphere in a spherical socket",
     "the minus sign in R1 R2 / (R1 - R2)"},
    {TYPO_TABLE_3, "Eq. (8)", "mutual approach with a zero-load radius a0", "a0 = 0",
     "a0 belongs to adhesive contact; Table III needs no such term, but has the 3/4 of Hertz's law "
     "outside the power 2/3, which makes it 9 % low"},
};

const size_t TYPOS_COUNT = sizeof TYPOS / sizeof *TYPOS;
