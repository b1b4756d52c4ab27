#include "protocols/file/calibration_file.hpp"
#include "protocols/file/observer_file.hpp"
#include "protocols/file/procedure_file.hpp"
#include "protocols/file/protocol_file.hpp"
#include "protocols/file/scene_file.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/process.hpp"

namespace {

/// Files of a kind, and whether the program takes one.
struct Kind {
    std::string name;
    Words files;
    std::function<void(const std::string& text)> parse;
};

std::string of_house(const std::string& file) {
    return PALPATE_SOURCE_DIR "/" + file;
}

/// Calibrations as `palpate commission` leaves them.
Words commissioned(const TemporaryFolder& folder) {
    engine::RigRecord record;
    record.device = "haply:/dev/ttyACM0";
    record.program = "0.1.0";
    record.calibration = std::string(64, 'a');
    record.mark = engine::Vec3(0.01, 0.02, 0.0);
    Words files;
    for (const std::string& of : {std::string("haplet"), of_house("examples/gantry.toml")}) {
        files.push_back(folder.file(fmt::format("commissioned_{}.toml", files.size())));
        write(files.back(), protocols::to_toml(protocols::load_calibration(of), record));
    }
    return files;
}

std::vector<Kind> kinds(const TemporaryFolder& folder) {
    Kind protocol{
        "protocol",
        {of_house("tests/golden/four_trials.toml"), of_house("tests/golden/free_forms.toml")},
        [](const std::string& text) {
            static_cast<void>(protocols::parse_protocol(text, "mutant"));
        }};
    for (const char* shipped :
         {"curvature_2afc", "friction_threshold", "patch_friction", "pilot", "shape_friction",
          "shape_friction_demo", "shape_friction_haply", "softness_2afc", "stress"}) {
        protocol.files.push_back(of_house(fmt::format("protocols/library/{}.toml", shipped)));
    }
    Kind calibration{"calibration", commissioned(folder), [](const std::string& text) {
                         static_cast<void>(protocols::parse_calibrations(text, "mutant"));
                     }};
    for (const char* shipped : {"protocols/library/pantographs.toml", "examples/gantry.toml",
                                "examples/udp_device.toml"}) {
        calibration.files.push_back(of_house(shipped));
    }
    const std::string observer = folder.file("observer.toml");
    write(observer, protocols::observer_example());
    const std::string corpus = of_house("tests/fuzz/corpus/");
    return {std::move(protocol),
            std::move(calibration),
            {"observer",
             {observer, corpus + "observer/typical.toml"},
             [](const std::string& text) {
                 static_cast<void>(protocols::parse_observer(text, "mutant"));
             }},
            {"scene",
             {corpus + "scene/nurbs_with_tracker.toml", corpus + "scene/surface.toml",
              corpus + "scene/two_lines.toml"},
             [](const std::string& text) {
                 static_cast<void>(protocols::parse_scene(text, "mutant"));
             }},
            {"procedure",
             {corpus + "procedure/identification.toml", corpus + "procedure/quest_plus.toml",
              corpus + "procedure/staircases.toml"},
             [](const std::string& text) {
                 static_cast<void>(protocols::parse_procedure(text, "mutant"));
             }}};
}

bool taken(const Kind& kind, const std::string& file) {
    try {
        kind.parse(slurp(file));
        return true;
    } catch (const protocols::ProtocolError&) {
        return false;
    }
}

/// Lines of mutants.py; none if its packages are not installed.
std::vector<Words> judged(const TemporaryFolder& folder, const Kind& kind) {
    const Finished printed = palpate_command({"words", "schema", "--of", kind.name});
    REQUIRE(printed.code == 0);
    write(folder.file("schema.json"), printed.out);
    const Words words = joined({"python3", of_house("tests/laws/mutants.py"),
                                folder.file("schema.json"), folder.path().string()},
                               kind.files);
    const Finished done = Process(words).wait();
    if (done.code == 127 || done.error.find("No module named") != std::string::npos) {
        WARN("python3-jsonschema is not installed: not checked");
        return {};
    }
    CAPTURE(done.error);
    REQUIRE(done.code == 0);
    return csv_rows(done.out, '\t');
}

}  // namespace

TEST_CASE("an independent validator and the program judge files alike, by the printed schema") {
    const TemporaryFolder folder;
    const std::vector<Kind> all = kinds(folder);
    const auto place = GENERATE(range(std::size_t{0}, std::size_t{5}));
    const Kind& kind = all.at(place);
    std::size_t wrong = 0;
    const auto lines = judged(folder, kind);
    for (const auto& line : lines) {
        const bool by_schema = line.at(2) == "taken";
        const bool by_program = taken(kind, line.at(1));
        CAPTURE(kind.name, line, line[0] == "shipped" ? "" : slurp(line[1]));
        if (line[0] == "shipped") {
            CHECK(by_schema);
            CHECK(by_program);
        } else if (line[0] == "wrong") {
            ++wrong;
            CHECK_FALSE(by_schema);
            CHECK_FALSE(by_program);
            if (kind.name == "protocol" && wrong % 200 == 0) {
                CHECK(palpate_command({"check", line[1]}).code == 2);
            }
        } else {
            CHECK((by_schema || !by_program));  // nothing that the program takes is refused
        }
    }
    CHECK((lines.empty() || wrong >= 100));
}
