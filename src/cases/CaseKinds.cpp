#include <array>

#include "mpm/cases/Case.hpp"

namespace mpm::cases {

std::unique_ptr<Case> make_pipe();
std::unique_ptr<Case> make_custom();
std::unique_ptr<Case> make_material_point();
std::unique_ptr<Case> make_triaxial();
std::unique_ptr<Case> make_biaxial();
std::unique_ptr<Case> make_patch();
std::unique_ptr<Case> make_mms1d();
std::unique_ptr<Case> make_column();
std::unique_ptr<Case> make_vortex();
std::unique_ptr<Case> make_bar();
std::unique_ptr<Case> make_discs();
std::unique_ptr<Case> make_rotation();
std::unique_ptr<Case> make_incline();
std::unique_ptr<Case> make_traction();
std::unique_ptr<Case> make_stability();
std::unique_ptr<Case> make_reversal();
std::unique_ptr<Case> make_cut_cell();
std::unique_ptr<Case> make_collapse();
std::unique_ptr<Case> make_gap();
std::unique_ptr<Case> make_hertz();
std::unique_ptr<Case> make_footing();

namespace {

constexpr std::array kinds{
    CaseKind{"pipe", "a rigid pipe pushed down into sand, plane strain: the main job", &make_pipe},
    CaseKind{"custom", "ground, rigid bodies, loads and stages put together by options",
             &make_custom},
    CaseKind{"material_point", "element tests of a law, without a grid", &make_material_point},
    CaseKind{"triaxial", "the paper's triaxial element tests in three dimensions", &make_triaxial},
    CaseKind{"biaxial", "plane-strain compression of sand under a rough plate", &make_biaxial},
    CaseKind{"patch", "constant stress in a box: what is left at nodes and walls", &make_patch},
    CaseKind{"mms1d", "vibrating bar with a manufactured solution at finite strain", &make_mms1d},
    CaseKind{"column", "elastic column under its own weight", &make_column},
    CaseKind{"vortex", "ring whose circles turn by different angles, exact at finite strain",
             &make_vortex},
    CaseKind{"bar", "elastic bar vibrating freely in its first mode", &make_bar},
    CaseKind{"discs", "two elastic discs that collide", &make_discs},
    CaseKind{"rotation", "disc turned by prescribed nodal velocities, or spinning freely",
             &make_rotation},
    CaseKind{"incline", "elastic block sliding on a rigid incline with friction", &make_incline},
    CaseKind{"traction", "elastic bar pulled at its end", &make_traction},
    CaseKind{"stability", "the largest stable Courant number of a basis and scheme",
             &make_stability},
    CaseKind{"reversal", "sand sheared, torn open and closed again by prescribed nodes",
             &make_reversal},
    CaseKind{"cut_cell", "shaken elastic body whose surfaces stand anywhere in their cells",
             &make_cut_cell},
    CaseKind{"collapse", "column of dry sand that collapses and runs out", &make_collapse},
    CaseKind{"gap", "elastic block or disc that approaches a rigid plane: when contact starts",
             &make_gap},
    CaseKind{"hertz", "elastic cylinder pressed on a rigid plane without friction", &make_hertz},
    CaseKind{"footing", "strip footing on weightless undrained clay", &make_footing},
};

}  // namespace

std::span<const CaseKind> case_kinds() {
  return kinds;
}

}  // namespace mpm::cases
