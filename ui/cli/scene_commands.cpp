#include <array>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "engine/base/files.hpp"
#include "protocols/file/protocol_file.hpp"
#include "data/csv/number_table.hpp"
#include "ui/cli/scene_tools.hpp"
#include "ui/command/command.hpp"

namespace palpate::ui {
namespace {

/// A scene and a table of points.
struct SceneOptions {
    std::string scene;
    std::string points;
    std::string output;  ///< empty: standard output
};

constexpr std::array<std::string_view, 4> kColumns{"t_s", "x_m", "y_m", "z_m"};

/// The columns that points of so many dimensions need, with or without time before them.
data::NumberTable read_points(const std::string& file, int dimension, bool with_time) {
    const std::span<const std::string_view> all(kColumns);
    const std::size_t first = with_time ? 0 : 1;
    const auto last = static_cast<std::size_t>(dimension) + 1;
    data::NumberTable points = data::read_numbers(file, all.subspan(first, last - first));
    for (std::size_t row = 0; row < points.rows(); ++row) {
        for (std::size_t column = with_time ? 1 : 0; column < points.columns.size(); ++column) {
            if (const double x = points.at(row, column); std::fabs(x) > protocols::kFarthest) {
                throw data::CsvError(fmt::format("{}:{}: {} is {}: give metres from {} to {}", file,
                                                 points.lines[row], points.columns[column], x,
                                                 -protocols::kFarthest, protocols::kFarthest));
            }
        }
    }
    return points;
}

void declare_scene(CommandWords& words, SceneOptions& options, const std::string& points) {
    words.add("SCENE", options.scene, "A scene file (TOML)").required();
    words.add(points, options.points, "A CSV file with a head").required();
    words.add("-o,--output", options.output, "Where to write; standard output without it");
}

int render(const SceneOptions& options) {
    const protocols::SceneFile scene = protocols::load_scene(options.scene);
    const data::NumberTable path = read_points(options.points, scene.dimension(), true);
    std::string text;
    try {
        text = render_csv(scene, path, options.points);
    } catch (const std::invalid_argument& e) {  // the curves do not make an object
        throw protocols::ProtocolError(fmt::format("{}:1:1: {}", options.scene, e.what()));
    }
    write_whole(options.output, text);
    return 0;
}

int closest(const SceneOptions& options) {
    const protocols::SceneFile scene = protocols::load_scene(options.scene);
    const data::NumberTable points = read_points(options.points, scene.dimension(), false);
    write_whole(options.output, closest_csv(scene, points));
    return 0;
}

}  // namespace

Command render_command() {
    return make_command<SceneOptions>(
        "render", "Feel a trajectory (t_s,x_m,y_m[,z_m]): forces tick by tick",
        [](CommandWords& words, SceneOptions& options) {
            declare_scene(words, options, "TRAJECTORY");
        },
        render);
}

Command closest_command() {
    return make_command<SceneOptions>(
        "closest", "Global closest points of a scene (x_m,y_m[,z_m])",
        [](CommandWords& words, SceneOptions& options) { declare_scene(words, options, "POINTS"); },
        closest);
}

}  // namespace palpate::ui
