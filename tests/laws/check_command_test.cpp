#include "protocols/file/calibration_file.hpp"
#include "tests/support/program.hpp"
#include "tests/support/short_text.hpp"

namespace {

void replace(const std::string& file, const std::string& from, const std::string& to) {
    write(file, replaced(slurp(file), from, to));
}

}  // namespace

TEST_CASE("a new protocol passes check, and is never written over a file") {
    for (const char* from : {"shape_friction", "shape_friction_demo", "shape_friction_haply"}) {
        CAPTURE(from);
        const TemporaryFolder folder;
        const std::string file = folder.file("Mine.toml");
        ran({"new", file, "--from", from});
        CHECK_THAT(ran({"check", file}).out, StartsWith("mine: Mine\nprotocol "));

        const std::string before = slurp(file);
        CHECK_THAT(ran({"new", file}, 2).error, Has("is there already"));
        CHECK(slurp(file) == before);
        CHECK(folder.names() == Words{"Mine.toml"});
    }
}

TEST_CASE("new says what comes next as a shell takes it") {
    const TemporaryFolder folder;
    CHECK_THAT(ran({"new", folder.file("two words.toml")}).out, Has("/two words.toml'\n"));
}

TEST_CASE("new refuses wrong words and paths, and makes nothing") {
    const TemporaryFolder folder;
    CHECK_THAT(ran({"new", folder.file("a.toml"), "--from", "shape"}, 2).error,
               Has("give one of curvature_2afc, "));
    CHECK_THAT(ran({"new", folder.file("no/a.toml")}, 2).error, Has("check the path"));
    CHECK(folder.names().empty());
    CHECK_THAT(
        ran({"new", "--keys"}).out,
        Has("damping_n_s_per_m", "first_order", ", or another law; each reads keys") && !Has("]("));
}

TEST_CASE("check says how many trials, which limits and how long, and draws the objects") {
    const TemporaryFolder folder;
    const Finished check =
        ran({"check", "shape_friction", "--long", "--svg", folder.file("objects.svg")});
    // 114 trials at 35.4 s, 107 gaps of 1.5 s and 6 breaks of 30 s: 72.9 min, see the test of the
    // duration.
    CHECK_THAT(check.out, Has("114 trials: 10 practice, 100 main in 1 block, 4 catch\n",
                              "object 2 (limit 2), friction 3 (limit 3)\n",
                              "\nduration 73 min if every trial is felt until the prompt",
                              "nothing stands against it"));
    CHECK_THAT(slurp(folder.file("objects.svg")), Has("convex_20"));
    CHECK(folder.names() == Words{"objects.svg"});
}

TEST_CASE("check warns of motors that are heard, not of a pointer's") {
    CHECK_THAT(ran({"check", "curvature_2afc"}).out, Has("motors can be heard"));
    CHECK_THAT(ran({"check", "curvature_2afc", "--device", "mouse"}).out,
               !Has("motors can be heard"));
}

TEST_CASE("check has exit code 2 for a wrong file and 1 for a device that cannot render it") {
    const TemporaryFolder folder;
    const std::string file = folder.file("p.toml");
    ran({"new", file});
    replace(file, "damping_n_s_per_m = 0 ", "damping_n_s_per_m = 50 ");
    CHECK_THAT(ran({"check", file}, 1).out, Has("it cannot be run", "with a damper of 50 N s/m"));
    ran({"check", file, "--device", "mouse"});  // gives no force
    // What check refuses, run refuses as well.
    CHECK(palpate_command(run_words(file, "P1", folder.file("d.sqlite"), {"--headless"})).code !=
          0);

    replace(file, "blocks = 1 ", "blocks = 3 ");
    const Finished wrong = ran({"check", file}, 2);
    CHECK(wrong.out.empty());
    CHECK_THAT(wrong.error, Has("blocks is 3"));
    ran({"check", folder.file("none.toml")}, 2);
    ran({"check", "shape_friction", "--device", "toaster"}, 2);
}

TEST_CASE("blocks and the first-order order of a file reach the plan that is run") {
    const TemporaryFile file("p.toml");
    ran({"new", file});
    replace(file, "blocks = 1 ", "blocks = 5 ");
    const Finished blocks = ran({"sequence", file, "--participant", "P1", "--csv"});
    CHECK_THAT(blocks.out, Has(",main,4,"));
    CHECK_THAT(palpate_command({"check", file}).out, Has("main in 5 blocks"));

    replace(file, "blocks = 5 ", "blocks = 1 ");
    replace(file, "catch_trials = 4", "catch_trials = 0");
    replace(file, "order = \"random\"", "order = \"first_order\"");
    CHECK_THAT(ran({"check", file, "--long"}).out,
               Has("first-order balanced", "111 trials: 11 practice, 100 main"));
}

TEST_CASE("check says how coarse encoders are without a power of ten") {
    const TemporaryFile file("coarse.toml");
    engine::Calibration coarse = protocols::load_calibration("2diy_gen3");
    coarse.pantograph.axes[0].counts_per_turn = coarse.pantograph.axes[1].counts_per_turn = 400.0;
    write(file, protocols::to_toml(coarse));
    const Finished said = palpate_command({"check", "shape_friction_haply", "--calibration", file});
    CHECK_THAT(said.out, Has("positions are read to within 9", " um: ", " mm/s at the very most"));
    CHECK_THAT(said.out, !Has("e+0"));
}

TEST_CASE("check says first how long it takes, where the breaks are and what to think of") {
    const TemporaryFile file("p.toml");
    ran({"new", file});
    const Finished before = palpate_command({"check", file});
    CHECK_THAT(before.out, Has("rest: positions are read to within "));
    CHECK_THAT(before.out, !Has("without a break: give") && !Has("there is no practice") &&
                               Has("friction is compared without masking noise"));
    replace(file, "break_every = 20", "break_every = 0");
    replace(file, "practice_repetitions = 1", "practice_repetitions = 0");
    replace(file, "catch_trials = 4", "catch_trials = 0");
    const Finished check = ran({"check", file});
    // 100 trials at 35.4 s and 99 gaps (see the test of the duration) are 61.5 minutes.
    std::size_t last = 0;
    for (const char* sentence :
         {"p: P\nprotocol ", "\nduration 62 min", "\nbreaks before trials: none",
          "\nlongest stretch without a break: 100 trials, 62 min",
          "warning: trials 1 to 100 take some 62 minutes without a break", "there is no practice",
          "there are no catch trials", "friction is compared without masking noise",
          "on simulated pantograph", "100 trials: 0 practice", "--long"}) {
        CAPTURE(sentence);
        const std::size_t at = check.out.find(sentence);
        REQUIRE(at != std::string::npos);
        CHECK(at >= last);
        last = at;
    }
    CHECK(std::count(check.out.begin(), check.out.end(), '\n') < 30);
    CHECK_THAT(palpate_command({"check", file, "--long"}).out,
               Has("trials of each condition", "from one main trial to the next"));
    std::ofstream(file, std::ios::app) << "\n[masking]\nnoise = \"pink\"\nlevel_db = -20\n";
    CHECK_THAT(palpate_command({"check", file}).out, !Has("without masking noise"));
    std::ofstream(file, std::ios::app) << "\n[instructions.en]\nready = \"Ready あ\"\n";
    CHECK_THAT(ran({"check", file}).out, Has("warning: [instructions.en] ready has \"あ\""));
    CHECK_THAT(palpate_command({"check", file, "--font", file}).error, Has("this is no font"));
}

TEST_CASE("a rule beside a design is answered at its place, with which to keep") {
    const TemporaryFile file("p.toml");
    ran({"new", file, "--from", "curvature_2afc"});
    ran({"check", file});
    // Also where the design says no more than what it would be anyway.
    replace(file, "[design]\n", "[design]\nrepetitions = 10\ncatch_trials = 4\n");
    const Finished check = ran({"check", file}, 2);
    CHECK_THAT(check.error, Has(place_of(slurp(file), "design]\nrepetitions") +
                                    "[design] says repetitions, catch_trials, and the rule of "
                                    "[procedure] in line ",
                                "keep [procedure]", "or keep [design]"));
    CHECK(std::count(check.error.begin(), check.error.end(), '\n') == 1);
}

TEST_CASE("check warns of instructions that the screen's language lacks, and of noise that is cut",
          "[cli][law]") {
    using namespace protocols;
    Protocol protocol = parse_protocol(short_text("shape_friction"), "p.toml");
    protocol.response.kind = ResponseKind::rating;
    protocol.response.question = "How round?";
    protocol.response.low = "not";
    protocol.response.high = "very";
    const TemporaryFile file("advised.toml");
    const auto others = [&] {  // what is said of plan and friction is not looked at here
        write(file, to_toml(protocol));
        std::string all;
        for (const std::string& sentence : lines_in(ran({"check", file}).out)) {
            const bool ours = sentence.find("instructions.") != std::string::npos ||
                              sentence.find("font lacks") != std::string::npos ||
                              sentence.find("full scale") != std::string::npos;
            all += ours ? sentence + "\n" : "";
        }
        return all;
    };
    CHECK(others().empty());
    protocol.instructions[0].welcome = "Hello";
    CHECK(others().empty());
    protocol.language = Language::tr;
    CHECK_THAT(others(), Has("[instructions.tr] has no welcome"));
    protocol.instructions[1].welcome = "Merhaba";
    CHECK(others().empty());
    for (const auto& [text, reason] : {std::pair{"Hissedin: あ", "\"あ\": the font lacks it"},
                                       std::pair{"חושו", "\"ח\": what runs from right to left"},
                                       std::pair{"חושו あ", "\"あ\": the font lacks it"}}) {
        protocol.instructions[1].choose = text;
        CHECK_THAT(others(), Has("[instructions.tr] choose has ", reason));
    }
    for (std::string* words :
         {&protocol.response.question, &protocol.response.low, &protocol.response.high}) {
        const std::string before = std::exchange(*words, "形");
        CHECK_THAT(others(), Has("has \"形\": the font lacks it"));
        *words = before;
    }
    protocol.title = "形";  // no screen has it
    protocol.instructions[1].choose = "Ποιο; Który? ¿Cuál? Ğüzel — “…”\n№ 5";
    CHECK(others().empty());
    protocol.masking = {.noise = Noise::pink, .level_db = -11.9};
    CHECK_THAT(others(), Has("is cut at full scale"));
    protocol.masking.noise = Noise::none;
    CHECK(others().empty());
}
