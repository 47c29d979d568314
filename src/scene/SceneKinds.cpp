#include <array>

#include "mpm/scene/Scene.hpp"

namespace mpm::scene {

std::unique_ptr<Scene> make_pipe();
std::unique_ptr<Scene> make_material_point();
std::unique_ptr<Scene> make_triaxial();
std::unique_ptr<Scene> make_biaxial();
std::unique_ptr<Scene> make_patch();
std::unique_ptr<Scene> make_mms1d();
std::unique_ptr<Scene> make_column();
std::unique_ptr<Scene> make_vortex();
std::unique_ptr<Scene> make_bar();
std::unique_ptr<Scene> make_discs();
std::unique_ptr<Scene> make_rotation();
std::unique_ptr<Scene> make_incline();
std::unique_ptr<Scene> make_traction();
std::unique_ptr<Scene> make_stability();
std::unique_ptr<Scene> make_reversal();
std::unique_ptr<Scene> make_cut_cell();
std::unique_ptr<Scene> make_collapse();
std::unique_ptr<Scene> make_gap();
std::unique_ptr<Scene> make_hertz();
std::unique_ptr<Scene> make_footing();

namespace {

constexpr std::array kinds{
    SceneKind{"pipe", "a rigid pipe pushed down into sand, plane strain: the main job", &make_pipe},
    SceneKind{"material_point", "element tests of a law, without a grid", &make_material_point},
    SceneKind{"triaxial", "the paper's triaxial element tests in three dimensions", &make_triaxial},
    SceneKind{"biaxial", "plane-strain compression of sand under a rough plate", &make_biaxial},
    SceneKind{"patch", "constant stress in a box: what is left at nodes and walls", &make_patch},
    SceneKind{"mms1d", "vibrating bar with a manufactured solution at finite strain", &make_mms1d},
    SceneKind{"column", "elastic column under its own weight", &make_column},
    SceneKind{"vortex", "ring whose circles turn by different angles, exact at finite strain",
              &make_vortex},
    SceneKind{"bar", "elastic bar vibrating freely in its first mode", &make_bar},
    SceneKind{"discs", "two elastic discs that collide", &make_discs},
    SceneKind{"rotation", "disc turned by prescribed nodal velocities, or spinning freely",
              &make_rotation},
    SceneKind{"incline", "elastic block sliding on a rigid incline with friction", &make_incline},
    SceneKind{"traction", "elastic bar pulled at its end", &make_traction},
    SceneKind{"stability", "the largest stable Courant number of a basis and scheme",
              &make_stability},
    SceneKind{"reversal", "sand sheared, torn open and closed again by prescribed nodes",
              &make_reversal},
    SceneKind{"cut_cell", "shaken elastic body whose surfaces stand anywhere in their cells",
              &make_cut_cell},
    SceneKind{"collapse", "column of dry sand that collapses and runs out", &make_collapse},
    SceneKind{"gap", "elastic block or disc that approaches a rigid plane: when contact starts",
              &make_gap},
    SceneKind{"hertz", "elastic cylinder pressed on a rigid plane without friction", &make_hertz},
    SceneKind{"footing", "strip footing on weightless undrained clay", &make_footing},
};

}  // namespace

std::span<const SceneKind> scene_kinds() {
  return kinds;
}

}  // namespace mpm::scene
