#include "protocols/design/plan_summary.hpp"
#include "protocols/design/session_plan.hpp"
#include "protocols/file/keys.hpp"
#include "protocols/file/protocol_file.hpp"
#include "protocols/library/shipped.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random.hpp"
#include "tests/support/slurp.hpp"

using namespace palpate::protocols;

namespace {

/// A number as people write it: rounded to some digits, or with all of them.
std::string number(Random& random, double lo, double hi) {
    const int digits = random.below(4) == 0 ? 17 : 1 + random.below(6);
    char text[64];
    std::snprintf(text, sizeof text, "%.*g", digits, random.in(lo, hi));
    return text;
}

/// A correct file with every number drawn at random.
std::string random_file(Random& random) {
    const auto n = [&](double lo, double hi) {
        return number(random, lo, hi);
    };
    std::string text =
        "format = 1\n[study]\nid = \"s\"\ntitle = \"a \\\"b\\\" \\\\ \u00e7\"\nseed = " +
        std::to_string(random.below(1000000)) + "\n";
    text += random.coin() ? "language = \"tr\"\nhandedness = \"left\"\n" : "handedness = \"any\"\n";
    text += "[apparatus]\nstiffness_n_per_m = " + n(1, 19000) + "\nforce_limit_n = " + n(0.1, 49) +
            (random.coin() ? "\ndamping_n_s_per_m = " + n(0, 90) : "") +
            "\nvertex_slew_mm_per_s = " + n(0, 9000) + "\nvertex_radius_mm = " + n(0.1, 19) +
            "\nstart_mm = [" + n(-30, 30) + ", " + n(70, 90) + "]\n";
    text += "[outline]\na_mm = [" + n(-50, -40) + ", 0]\nvertex_mm = [" + n(-2, 2) + ", " +
            n(35, 42) + "]\n";
    text += "[[object]]\nname = \"a\"\ncurvature_per_m = " + n(-10, -1) + "\n";
    text += "[[object]]\nname = \"b\"\ncurvature_per_m = " + n(1, 10) + "\n";
    text += "[[friction]]\nname = \"on\"\nlaw = \"gos\"\nmu_s = " + n(0.6, 0.9) +
            "\nmu_d = " + n(0.1, 0.5) + "\ntau_slip_ms = " + n(0, 900) +
            "\ntau_heal_ms = " + n(0, 900) + "\n";
    text += random.coin() ? "[safety]\nslew_limit_n_per_ms = " + n(0.01, 499) +
                                "\nspeed_limit_m_per_s = " + n(0.1, 9.9) +
                                "\nlate_in_a_row = " + std::to_string(random.below(101)) +
                                "\nlate_of_100 = " + std::to_string(random.below(101)) +
                                "\nenergy_limit_j = " + n(0.001, 9.9) +
                                "\ndead_man = " + (random.coin() ? "true" : "false") + "\n"
                          : "";
    text += random.coin() ? "[invalid]\nlate_share = " + n(0, 1) + "\ncontact_min_s = " + n(0, 99) +
                                "\npath_min_mm = " + n(0, 999) +
                                "\nmax_requeues = " + std::to_string(random.below(101)) + "\n"
                          : "";
    text +=
        "[design]\nrepetitions = 2\nmax_run_object = 0\nmax_run_friction = 0\ncatch_trials = 0\n";
    if (random.coin()) {  // two conditions, twice each: both orders are possible
        text += random.coin() ? "order = \"first_order\"\n" : "blocks = 2\norder = \"random\"\n";
    }
    text += "[timing]\ngap_s = " + n(0, 9) + "\n[observer]\nnoise_per_m = " + n(0, 9) + "\n";
    return text;
}

Protocol study_of(std::string_view name) {
    return parse_protocol(shipped_protocol(name).text, name);
}

}  // namespace

TEST_CASE("the default study is the one that is described") {
    const Protocol protocol = study_of("shape_friction");
    CHECK(protocol.id == "shape_friction");
    CHECK(protocol.objects.size() == 7);
    CHECK(protocol.frictions.size() == 2);
    CHECK(protocol.frictions[1].tau_slip == 0.02);
    // The structs' default members are this study's.
    CHECK(protocol.outline == OutlineSpec{});
    CHECK(protocol.apparatus == ApparatusSpec{});
    CHECK(protocol.safety == SafetySpec{});
    CHECK(protocol.invalid == InvalidSpec{});
    CHECK(protocol.design == DesignSpec{});
    CHECK(protocol.timing == TimingSpec{});
    CHECK(protocol.observer == ObserverSpec{});

    const Plan plan =
        make_plan(protocol, protocol_hash(protocol), {.participant = "p01"}, protocol.seed);
    CHECK(plan.trials.size() == 10 + 100 + 4);
    CHECK(plan.picture_order.size() == 5);
}

TEST_CASE("the demo is ten trials of the default study") {
    const Protocol study = study_of("shape_friction");
    const Protocol demo = study_of("shape_friction_demo");
    CHECK(std::vector(study.objects.begin(), study.objects.begin() + 5) == demo.objects);
    CHECK(study.frictions == demo.frictions);
    CHECK(study.outline == demo.outline);
    CHECK(study.apparatus == demo.apparatus);
    CHECK(study.timing.explore_timeout == demo.timing.explore_timeout);

    const Plan plan = make_plan(demo, protocol_hash(demo), {.participant = "p01"}, demo.seed);
    CHECK(plan.trials.size() == 10);
}

TEST_CASE("what is written is read back to the last bit") {
    SEEDED(random, std::uint64_t{300});
    const std::string file = random_file(random);
    CAPTURE(file);
    const Protocol protocol = parse_protocol(file, "random.toml");
    const std::string text = to_toml(protocol);
    CAPTURE(text);
    CHECK(parse_protocol(text, "canonical.toml") == protocol);
    CHECK(to_toml(parse_protocol(text, "canonical.toml")) == text);
}

TEST_CASE("whole millimetres are read as the double of their decimal in metres") {
    const Protocol study = study_of("shape_friction");
    const std::string text = to_toml(study);
    const std::string start = "start_mm = [0, 60]";
    for (int x = -400; x <= 400; ++x) {
        const std::string number = std::to_string(x);
        std::string changed = text;
        changed.replace(changed.find(start), start.size(), "start_mm = [" + number + ", 60]");
        CHECK(parse_protocol(changed, "x.toml").apparatus.start.x == std::stod(number + "e-3"));
    }
}

TEST_CASE("numbers are written as short as they can be") {
    const std::string text = to_toml(study_of("shape_friction"));
    CHECK_THAT(text, Has("a_mm = [-40, 0]\n", "vertex_radius_mm = 3\n", "tau_slip_ms = 20\n",
                         "mu_s = 0.7\n", "noise_per_m = 2.62\n"));
}

TEST_CASE("each key is part of the hash as soon as it differs") {
    const Protocol study = study_of("shape_friction");
    std::set<std::string> hashes{protocol_hash(study)};
    const auto differs = [&](const auto& change) {
        Protocol other = study;
        change(other);
        const std::string text = to_toml(other);
        CAPTURE(text);
        CHECK(hashes.insert(protocol_hash(other)).second);
        CHECK(parse_protocol(text, "a") == other);
    };
    differs([](Protocol& p) { p.safety.slew_limit = 1000.0; });
    differs([](Protocol& p) { p.safety.speed_limit = 1.0; });
    differs([](Protocol& p) { p.safety.late_run = 0; });
    differs([](Protocol& p) { p.safety.late_share = 51; });
    differs([](Protocol& p) { p.safety.energy_limit = 0.2; });
    differs([](Protocol& p) { p.safety.dead_man = true; });
    differs([](Protocol& p) { p.apparatus.damping = 0.1; });
    differs([](Protocol& p) { p.design.blocks = 5; });
    differs([](Protocol& p) { p.design.catch_trials = 0; });
    differs([](Protocol& p) {
        p.design.catch_trials = 0;
        p.design.order = OrderRule::first_order;
    });
    differs([](Protocol& p) { p.language = Language::tr; });
    differs([](Protocol& p) { p.handedness = Handedness::any; });
    differs([](Protocol& p) { p.invalid.late_share = 0.01; });
    differs([](Protocol& p) { p.invalid.contact_min = 0.0; });
    differs([](Protocol& p) { p.invalid.path_min = 0.2; });
    differs([](Protocol& p) { p.invalid.max_requeues = 3; });
    differs([](Protocol& p) { p.consent_required = true; });
}

TEST_CASE("the hash sees values, not spelling") {
    std::string text(shipped_protocol("shape_friction").text);
    const std::string hash = protocol_hash(parse_protocol(text, "a"));
    const auto with = [&](const std::string& from, const std::string& to) {
        return protocol_hash(parse_protocol(replaced(text, from, to), "b"));
    };
    CHECK(with("mu_s = 0.7", "mu_s = 7.0e-1 # the same") == hash);
    CHECK(with("gap_s = 1.5", "") == hash);  // its default
    CHECK(with("curvature_per_m = 0", "curvature_per_m = -0.0") == hash);
    CHECK(with("mu_s = 0.7", "mu_s = 0.71") != hash);
    CHECK(with("seed = 20260114", "seed = 20260115") != hash);
}

TEST_CASE("a byte order mark and Windows line ends do not matter") {
    const std::string text = to_toml(study_of("shape_friction"));
    std::string windows = "\xef\xbb\xbf";
    for (const char c : text) {
        windows += c == '\n' ? std::string("\r\n") : std::string(1, c);
    }
    CHECK(to_toml(parse_protocol(windows, "windows.toml")) == text);
}

TEST_CASE("every row of the keys as Markdown has five cells, and every key a meaning") {
    std::size_t rows = 0;
    for (const std::string& line : lines_in(keys_markdown())) {
        if (line.starts_with("| `")) {
            CAPTURE(line);
            ++rows;
            std::size_t bars = 0;
            for (std::size_t i = 0; i < line.size(); ++i) {
                bars += line[i] == '|' && (i == 0 || line[i - 1] != '\\') ? 1U : 0U;
            }
            CHECK(bars == 6);
            CHECK(line.find("|  |", line.size() - 5) == std::string::npos);
        }
    }
    CHECK(rows > 200);
    for (const char* row : {"| `title` |  | text | required |", "| `dead_man` |  | true or false |",
                            "| `gap_s` | s | 0 to 60 | 1.5 |"}) {
        CHECK_THAT(keys_markdown(), Has(row));
    }
}

TEST_CASE("the reference for people names every key of the canonical text") {
    const std::string reference = key_reference();
    Protocol study = study_of("shape_friction");
    study.safety.dead_man = true;  // or the table would be left out, as would be these
    study.apparatus.damping = 0.1;
    study.design.blocks = 5;
    study.language = Language::tr;
    study.handedness = Handedness::any;
    study.invalid.max_requeues = 0;
    study.consent_required = true;
    for (const std::string& line : lines_in(to_toml(study))) {
        if (const auto equals = line.find(" = "); equals != std::string::npos) {
            CHECK_THAT(reference, Has(line.substr(0, equals)));
        }
    }
}

TEST_CASE("a new protocol is the shipped one but for id and title, with all its comments") {
    for (const ShippedProtocol& shipped : shipped_protocols()) {
        CAPTURE(shipped.name);
        const std::string text = new_protocol(shipped, "my_study");
        Protocol made = parse_protocol(text, "my_study.toml");
        const Protocol from = parse_protocol(shipped.text, shipped.name);
        CHECK(made.id == "my_study");
        CHECK(made.title == "My study");
        CHECK(protocol_hash(made) != protocol_hash(from));
        made.id = from.id;
        made.title = from.title;
        CHECK(made == from);
        const auto hashes = [](std::string_view lines) {
            return std::count(lines.begin(), lines.end(), '#');
        };
        CHECK(hashes(text) == hashes(shipped.text) + 3);
    }
}

TEST_CASE("whatever a file is called, the study gets an id that a protocol may have") {
    CHECK(id_of("My study-2") == "my_study_2");
    CHECK(id_of("şekil") == "ekil");
    CHECK(id_of("..") == "study");
    CHECK(id_of("") == "study");
    const ShippedProtocol& shipped = shipped_protocol("shape_friction_demo");
    for (std::uint64_t seed = 0; seed < 300; ++seed) {
        Random random(seed);
        std::string name;
        for (int i = random.below(90); i > 0; --i) {
            name += static_cast<char>(random.below(256));
        }
        CAPTURE(seed, name);
        const std::string id = id_of(name);
        CHECK(parse_protocol(new_protocol(shipped, id), "p.toml").id == id);
    }
}

TEST_CASE("a protocol that does not ship is refused with those that do") {
    CHECK_THROWS_WITH(shipped_protocol("shape"), Has("\"shape\"") && Has("shape_friction_haply"));
}

TEST_CASE("the duration adds what every trial and every break take") {
    // By hand: 114 trials, breaks before the main phase and after 20, 40, 60, 80 and 100 of 104: 6.
    // Around the exploration: 2 * 0.2 s of ramp, 2 s to get ready, 3 s to choose; 1.5 s of gap
    // between two trials where there is no break: 107 times.
    Protocol study = parse_protocol(shipped_protocol("shape_friction").text, "p.toml");
    const Plan plan = make_plan(study, protocol_hash(study), {.participant = "p01"}, study.seed);
    const Duration duration = duration_of(plan, study);
    constexpr double kBetween = 107 * 1.5 + 180.0;
    CHECK_THAT(duration.shortest, Catch::Matchers::WithinRel(114 * 2.4 + kBetween, 1e-12));
    CHECK_THAT(duration.prompted, Catch::Matchers::WithinRel(114 * 35.4 + kBetween, 1e-12));
    CHECK_THAT(duration.longest, Catch::Matchers::WithinRel(114 * 50.4 + kBetween, 1e-12));
    study.response.confidence = true;
    CHECK_THAT(duration_of(plan, study).prompted,
               Catch::Matchers::WithinRel(duration.prompted + 114 * 3.0, 1e-12));
    study.response.confidence = false;
    study.response.feedback = Feedback::practice;
    CHECK_THAT(duration_of(plan, study).shortest,
               Catch::Matchers::WithinRel(duration.shortest + 10.0, 1e-12));
    study.response.feedback = Feedback::all;
    CHECK_THAT(duration_of(plan, study).longest,
               Catch::Matchers::WithinRel(duration.longest + 114.0, 1e-12));
}
