#include "engine/base/files.hpp"
#include "data/csv/number_table.hpp"
#include "ui/cli/scene_tools.hpp"
#include "ui/cli/trajectory.hpp"
#include "ui/command/command.hpp"

namespace palpate::ui {
namespace {

/// A scene and a table of points.
struct SceneOptions {
    std::string scene;
    std::string points;
    std::string output;  ///< empty: standard output
};

data::NumberTable read_points(const std::string& file, int dimension) {
    data::NumberTable points = data::read_numbers(file, point_columns(dimension, false));
    for (std::size_t row = 0; row < points.rows(); ++row) {
        for (std::size_t column = 0; column < points.columns.size(); ++column) {
            check_reach(file, points.lines[row], points.columns[column], points.at(row, column));
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
    render_csv(scene, options.scene, options.points, options.output);
    return 0;
}

int closest(const SceneOptions& options) {
    const protocols::SceneFile scene = protocols::load_scene(options.scene);
    const data::NumberTable points = read_points(options.points, scene.dimension());
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
