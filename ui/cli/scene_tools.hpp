#pragma once

#include <filesystem>
#include <string>

#include "protocols/file/scene_file.hpp"
#include "data/csv/number_table.hpp"

/// What the offline tools compute, as CSV texts. Column names carry the units; numbers are written
/// in the fewest digits that read back as the same double.
namespace palpate::ui {

/// Feels a trajectory (columns t_s, x_m, y_m and in space z_m): one row a tick with mode, closest
/// point, god-object and the force on the user. The tick period is that of t_s. The trajectory is
/// read twice, first to check it whole, and never held whole: paths may be longer than the memory.
///
/// t_s,mode,segment,u,cp_x_m,cp_y_m,go_x_m,go_y_m,fn_n,ft_n,fx_n,fy_n,held,slewed,unproven (in
/// space v and z columns too); segment and u are those of the closest point, on a vertex the end of
/// the segment before it; the god-object out of contact is that point. The last three are 0 or 1:
/// an open end (a border or crease in space) held the god-object outside of its cone; the vertex
/// slew ended its walk; its search was broken off before a proof.
/// @param scene_name  its file, for messages
/// @param output      empty: standard output
/// @throws data::CsvError as Trajectory; protocols::ProtocolError if the curves do not make an
///         object; and as palpate::write_whole()
void render_csv(const protocols::SceneFile& scene,
                const std::string& scene_name,
                const std::filesystem::path& path,
                const std::filesystem::path& output);

/// The global closest point of each row: segment,u,cp_x_m,cp_y_m,distance_m (in space v and cp_z_m
/// too).
[[nodiscard]] std::string closest_csv(const protocols::SceneFile& scene,
                                      const data::NumberTable& points);

}  // namespace palpate::ui
