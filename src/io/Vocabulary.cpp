#include "mpm/io/Vocabulary.hpp"

#include <array>

namespace mpm::io {
namespace {

constexpr std::array run_answers{
    Answer{"scene", "", "the case that was run"},
    Answer{"version", "", "version of the program"},
    Answer{"git_hash", "", "commit that the program was built from"},
    Answer{"option_*", "", "the option of this name, as it was used"},
    Answer{"warnings", "", "sentences about what makes the answer doubtful: see docs/checks.md"},
    Answer{"answer_withheld", "",
           "why there is no answer (exit code 4): sentences of the checks that contradict it"},
    Answer{"check_*", "", "what the check of this name has measured to the end of the run"},
    Answer{"ranks", "1", "MPI processes"},
    Answer{"instruction_set", "", "for which the libraries in use were built"},
    Answer{"courant", "1", "time step as a share of h/(c + |v|)"},
    Answer{"cells", "1", "of the background grid"},
    Answer{"particles", "1", "at the end"},
    Answer{"particles_lost", "1", "always 0: a lost particle stops the run"},
    Answer{"load_max_over_mean", "1",
           "largest over mean number of particles of a rank, at the end"},
    Answer{"rebalancings", "1", "times that cells got new owners"},
    Answer{"steps", "1", "time steps of all stages; increments of a test without a grid"},
    Answer{"simulated_time_s", "s", "at the end, on the clock of the outputs"},
    Answer{"step_loop_s", "s", "wall time of the steps, output excluded"},
    Answer{"wall_s", "s", "wall time of the whole process"},
    Answer{"particle_updates_per_s", "1/s", "particles times steps over step_loop_s"},
    Answer{"bytes_per_particle", "B", "memory of a particle's own fields"},
    Answer{"peak_memory_bytes", "B", "largest resident memory, summed over the ranks"},
};

constexpr std::array balance_answers{
    Answer{"mass_kg", "kg", "of all particles at the end (per metre in plane strain)"},
    Answer{"mass_change_share", "1", "its change since the start, as a share"},
    Answer{"momentum_*_N_s", "N s", "of all particles at the end, per direction"},
    Answer{"kinetic_energy_J", "J", "of all particles at the end"},
    Answer{"ledger_*", "", "mass, momentum by cause and energy by cause: see docs/ledger.md"},
};

constexpr std::array body_answers{
    Answer{"body_*_way_m", "m", "how far the rigid body of this name is from where it began"},
    Answer{
        "body_*_largest_force_*", "",
        "largest force of the ground on it in a row of history.csv, N (per metre in plane strain)"},
    Answer{"body_*", "", "the columns of its last row of history.csv: see docs/custom.md"},
};

constexpr std::array stress_answers{
    Answer{
        "error_stress_mean", "1",
        "mean over the particles of |stress - exact|, as a share of the largest exact stress; in "
        "traction, where the exact stress is uniform, 1 - traction_share_kept"},
    Answer{"error_stress_peak", "1",
           "largest |stress - exact| of a particle, as a share of the largest exact stress"},
    Answer{"error_stress_norm", "1", "largest relative error of the norm of a particle's stress"},
    Answer{"error_displacement_rms", "1",
           "root mean square over the particles of the error of displacement, as a share of the "
           "amplitude; the largest over time"},
    Answer{"traction_share_kept", "1", "mean stress of the bar over the traction on its end"},
    Answer{"residual_max", "1",
           "largest nodal force under constant stress, as a share of stress times cell face"},
    Answer{"time_to_failure_s", "s",
           "when the error first passed -failure_share, or the run stopped"},
};

constexpr std::array energy_answers{
    Answer{"energy_start_J", "J", "kinetic and strain energy at the start"},
    Answer{"energy_end_J", "J", "kinetic and strain energy at the end"},
    Answer{"energy_ratio", "1",
           "energy at the end over that at the start; of two discs the kinetic energy returned, in "
           "the frame of their centre"},
    Answer{"total_energy_ratio", "1",
           "kinetic and strain energy of two discs at the end over that at the start, in the frame "
           "of their centre"},
    Answer{"restitution", "1", "speed of parting over speed of closing of two discs"},
    Answer{"error_momentum", "1", "largest change of the total momentum, as a share of one disc's"},
    Answer{"error_phase", "rad", "of the vibration at the end"},
    Answer{"error_angle_rad", "rad",
           "of the rotation of a disc, or of the direction of its stress"},
    Answer{"error_angular_momentum", "1", "relative change of the angular momentum"},
    Answer{"error_volume_ratio", "1", "relative change of the total volume"},
    Answer{"largest_strain_rate_over_omega", "1",
           "largest strain rate of a free disc's first step over its angular velocity"},
    Answer{"energy_growth", "1", "largest energy over that at the start, over all offsets"},
    Answer{"worst_offset", "cells", "place of the surface in its cell with the largest growth"},
    Answer{"offsets", "1", "places of the surface that were tried"},
    Answer{"stable_offsets", "1", "places at which the energy did not grow for good"},
    Answer{"stable", "1", "1 where all places are stable, else 0"},
};

constexpr std::array stability_answers{
    Answer{"search_end", "1", "Courant number at which the search ends"},
    Answer{"stable_courant", "1", "limit of the method that runs go by"},
    Answer{"limit_interior", "1", "largest stable Courant number inside a body"},
    Answer{"limit_fixed_wall", "1", "the same beside fixed walls"},
    Answer{"limit_filled_to_free_end", "1", "the same in a box filled to the grid's free ends"},
    Answer{"limit_free_surface", "1", "the same of a free body, at its worst place in the cells"},
    Answer{"worst_place", "cells", "this place, per direction"},
    Answer{"two_over_omega_free_surface", "1",
           "2/omega of the assembled free body, as a Courant number"},
};

constexpr std::array contact_answers{
    Answer{"error_gap_cells", "cells", "first contact minus true gap"},
    Answer{"slide_m", "m", "way of the body down the incline"},
    Answer{"slide_exact_m", "m", "the same of a rigid body"},
    Answer{"error_slide", "1", "relative error of this way"},
    Answer{"contact_pressure_peak_Pa", "Pa", "largest pressure of a column of nodes"},
    Answer{"contact_pressure_peak_particles_Pa", "Pa",
           "largest mean pressure of the particles of a lowest cell"},
    Answer{"contact_pressure_exact_Pa", "Pa", "largest pressure by Hertz"},
    Answer{"error_contact_pressure", "1", "relative error of the largest pressure of nodes"},
    Answer{"error_contact_pressure_particles", "1",
           "relative error of the largest pressure of particles"},
    Answer{"contact_half_width_m", "m", "from the second moment of the pressure"},
    Answer{"contact_half_width_exact_m", "m", "by Hertz"},
    Answer{"error_contact_half_width", "1", "its relative error"},
    Answer{"contact_force_N_per_m", "N/m", "of the plane on the cylinder"},
    Answer{"capacity_over_c", "1", "mean pressure under the footing on the plateau over c"},
    Answer{"error_bearing_capacity", "1", "relative error against 2 + pi"},
    Answer{"plateau_rise", "1", "rise of the pressure along the plateau over 2 + pi"},
};

constexpr std::array sand_answers{
    Answer{"q_peak_Pa", "Pa", "largest deviatoric stress"},
    Answer{"p_at_peak_Pa", "Pa", "mean stress there"},
    Answer{"strain_at_peak", "1", "axial strain at the largest stress"},
    Answer{"q_end_Pa", "Pa", "deviatoric stress at the end"},
    Answer{"p_end_Pa", "Pa", "mean stress at the end"},
    Answer{"volumetric_strain_end", "1", "at the end, compression positive"},
    Answer{"void_ratio_end", "1", "at the end"},
    Answer{"q_peak_material_point_Pa", "Pa", "largest q of the same test at a single point"},
    Answer{"error_q", "1", "largest difference to that curve, as a share of its peak"},
    Answer{"error_volumetric_strain", "1", "largest difference of volumetric strain to it"},
    Answer{"stress_spread_max", "1",
           "largest deviation of a particle's stress from the mean, as a share of p"},
    Answer{"kinetic_energy_over_work_max", "1", "largest kinetic energy over the work done"},
    Answer{"cycles_done", "1", "cycles of shearing, tearing and closing"},
    Answer{"error_surface", "1",
           "largest distance of a particle's state from the loading surface, in p"},
    Answer{"error_volume", "1", "largest relative error of a particle's volume"},
    Answer{"stress_in_gap_max", "1", "largest stress that an open gap should not have"},
    Answer{"gap_volume_ratio_max", "1", "largest opening of a particle"},
    Answer{"share_plastic", "1", "of all particle steps"},
    Answer{"share_at_floor", "1", "of all particle steps, at the pressure floor or open"},
    Answer{"loop_work_J_per_m3", "J/m^3", "work of the closed elastic loop"},
    Answer{"loop_work_exact_J_per_m3", "J/m^3", "the same by the elastic law"},
    Answer{"error_loop_work", "1", "its relative error"},
    Answer{"run_out", "1", "of the collapsed column, in its width"},
    Answer{"run_out_measured", "1", "1.2 times the aspect ratio, as in experiments"},
    Answer{"error_run_out", "1", "relative difference of the two"},
    Answer{"final_height_over_width", "1", "of the heap, in the column's width"},
    Answer{"kinetic_energy_share_at_end", "1", "of weight times half the height"},
};

constexpr std::array biaxial_answers{
    Answer{"consolidation_out_of_balance", "1", "unbalanced force at its end, as a share"},
    Answer{"consolidation_steps", "1", "steps of the consolidation"},
    Answer{"stress_peak_Pa", "Pa", "largest mean vertical stress under the plate"},
    Answer{"stress_residual_Pa", "Pa", "mean vertical stress over the last 1 % of axial strain"},
    Answer{"axial_strain_end", "1", "of the last row"},
    Answer{"stress_difference_rms", "1",
           "relative difference of the plate's force by contour and by impulse, rms over the rows"},
    Answer{"stress_difference_max", "1", "the largest one"},
};

constexpr std::array pipe_answers{
    Answer{"N_df", "1", "dimensionless resistance at the failure threshold; null if there is none"},
    Answer{"u_df_over_D", "1", "displacement there over the diameter"},
    Answer{"N_df_low*", "1", "lower end of its interval"},
    Answer{"N_df_high*", "1", "upper end of its interval"},
    Answer{"u_df_over_D_low*", "1", "lower end of its interval"},
    Answer{"u_df_over_D_high*", "1", "upper end of its interval"},
    Answer{"N_df_to_*", "1", "the threshold read from the curve up to this u/D"},
    Answer{"u_df_over_D_to_*", "1", "displacement there over the diameter"},
    Answer{"threshold_found*", "1", "1 where a threshold was found, else 0"},
    Answer{"threshold_window*", "1", "u/D up to which the curve was read"},
    Answer{"threshold_resamples_found*", "1",
           "share of resampled curves on which a threshold was found"},
    Answer{"threshold_reason", "", "why there is none; empty if there is one"},
    Answer{"slope_before*", "1", "mean slope of N_d before the threshold"},
    Answer{"slope_after*", "1", "mean slope of N_d after it"},
    Answer{"ala_N_d_phi*", "1", "resistance by ALA's equations at this friction angle in degrees"},
    Answer{"ala_phi*_deg", "degrees", "friction angle at which ALA's equations give N_df"},
    Answer{"N_d_end", "1", "resistance of the last row"},
    Answer{"u_over_D_end", "1", "displacement of the last row over the diameter"},
    Answer{"reaction_difference_rms", "1",
           "relative difference of the reactions by contour and by impulse, rms over u/D from 0.05 "
           "to 0.9 in steps of 0.01"},
    Answer{"reaction_difference_max", "1", "the largest one"},
    Answer{"geostatic_out_of_balance", "1", "unbalanced force at the end of the stage, in weights"},
    Answer{"geostatic_steps", "1", "steps of the stage"},
    Answer{"geostatic_N_d", "1", "reaction at rest"},
    Answer{"geostatic_N_d_expected", "1", "pi/(4 H/D), the weight of the ground displaced"},
    Answer{"geostatic_vertical_stress_error_rms", "1",
           "of the vertical stress against gamma z beyond 2 D, as a share of its rms"},
    Answer{"geostatic_K0_error_rms", "1", "of the horizontal stress against K0 times the vertical"},
    Answer{"symmetry", "", "half or full model"},
    Answer{"unit_weight_N_per_m3", "N/m^3", "of the ground at the start"},
    Answer{"reference_force_N_per_m", "N/m", "gamma H D"},
    Answer{"friction_coefficient", "1", "between ground and pipe"},
    Answer{"relative_density", "1", "of the sand at the start"},
    Answer{"particles_in_pipe_most", "1",
           "particles deeper in the pipe than 2 % of its radius, most of all rows of the history"},
    Answer{
        "inertia_at_threshold", "1",
        "kinetic energy over the work of the reaction on D/400, just before the threshold: about "
        "the share that inertia adds to N_d"},
    Answer{"cell_over_d50", "1", "cell near the pipe over the grains' mean diameter"},
};

constexpr std::array groups{
    AnswerGroup{"The run", run_answers},
    AnswerGroup{"Mass, momentum and energy", balance_answers},
    AnswerGroup{"Pipe", pipe_answers},
    AnswerGroup{"Biaxial test", biaxial_answers},
    AnswerGroup{"Sand: element tests, reversal, collapse", sand_answers},
    AnswerGroup{"Rigid bodies of -scene custom", body_answers},
    AnswerGroup{"Stress and displacement against exact solutions", stress_answers},
    AnswerGroup{"Energy and motion against exact solutions", energy_answers},
    AnswerGroup{"Contact and bearing capacity against exact solutions", contact_answers},
    AnswerGroup{"Stability", stability_answers},
};

/// Whether a key is that of a declaration with at most one `*`.
bool matches(std::string_view key, std::string_view declared) {
  const std::size_t star = declared.find('*');
  if (star == std::string_view::npos) return key == declared;
  const std::string_view before = declared.substr(0, star), after = declared.substr(star + 1);
  return key.size() >= before.size() + after.size() && key.starts_with(before) &&
         key.ends_with(after);
}

}  // namespace

std::span<const AnswerGroup> vocabulary() {
  return groups;
}

const Answer* find_answer(std::string_view key) {
  for (const AnswerGroup& group : groups)
    for (const Answer& answer : group.answers)
      if (matches(key, answer.key)) return &answer;
  return nullptr;
}

}  // namespace mpm::io
