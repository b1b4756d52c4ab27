#include "tests/support/placed_lines.hpp"
#include "tests/support/short_text.hpp"
#include "tests/support/test_text.hpp"

using namespace palpate::protocols;

namespace {

const std::string kDefaultStudy = short_text("shape_friction");

/// Tables that the default study leaves out.
constexpr std::string_view kYounger =
    "[masking]\nnoise = \"pink\"\nlevel_db = -24\n[instructions.en]\nwelcome = "
    "\"Feel.\\nAnswer.\"\n"
    "[instructions.tr]\nwelcome = \"Hissedin.\"\nbreak = \"Mola\"\n";

}  // namespace

TEST_CASE("every wrong file is refused at the right place, with the value and a remedy") {
    REQUIRE(refusal(kDefaultStudy) == "accepted");
    // One change to the default study, where in the changed text the message must point, and what
    // it must say.
    for (const auto& row : test_rows("protocol_problems.tsv")) {
        const std::string &from = row.at(0), &to = row.at(1), &at = row.at(2), &says = row.at(3);
        const std::string text = replaced(kDefaultStudy, from, to);
        CAPTURE(from, to);
        const std::string said = refusal(text);
        CHECK_THAT(said, Has(says));
        CHECK_THAT(said, StartsWith(says == "not TOML" ? "p.toml:" : place_of(text, at)));
    }
}

TEST_CASE("run limits that no order can keep point at the limit") {
    std::string text = kDefaultStudy;
    const std::string second = "name = \"on\"";
    // Only one friction left: every trial has it.
    text.erase(text.find("[[friction]]\n" + second),
               text.find("[design]") - text.find("[[friction]]\n" + second));
    const std::string said = refusal(text);
    CHECK_THAT(said, StartsWith(place_of(text, "3     # two levels")));
    CHECK_THAT(said, Has("max_run_friction is 3: ", "0 for no limit"));
    text = replaced(text, "max_run_friction = 3", "#");
    CHECK_THAT(refusal(text), StartsWith(place_of(text, "design]")) &&
                                  Has("max_run_friction is 3, its default: ",
                                      "0 for no limit: add max_run_friction = 0 to [design]"));
}

TEST_CASE("catch trials need an object that is not pictured") {
    std::string text = kDefaultStudy;
    for (std::size_t at = 0; (at = text.find("pictured = false\n")) != std::string::npos;) {
        text.erase(at, std::string("pictured = false\n").size());
    }
    CHECK_THAT(refusal(text),
               StartsWith(place_of(text, "4         # both")) &&
                   Has("catch_trials is 4, but every object is pictured", "or give 0"));
    text = replaced(text, "catch_trials = 4", "#");
    CHECK_THAT(refusal(text), StartsWith(place_of(text, "design]")) &&
                                  Has("catch_trials is 4, its default, but every object",
                                      "or add catch_trials = 0 to [design]"));
}

TEST_CASE("a first-order order says all that it needs, and then needs no run limit") {
    const std::string text =
        replaced(kDefaultStudy, "order = \"random\"", "order = \"first_order\"");
    const std::string said = refusal(
        edited(text, {{"repetitions = 10 ", "repetitions = 9 "}, {"blocks = 1 ", "blocks = 3 "}}));
    CHECK(std::count(said.begin(), said.end(), '\n') == 2);
    CHECK_THAT(said, Has("lets each of 10 conditions follow each"));
    CHECK(refusal(edited(text, {{"catch_trials = 4", "catch_trials = 0"},
                                {"max_run_object = 2", "max_run_object = 1"}})) == "accepted");
}

TEST_CASE("fewer than two pictures are no choice") {
    const std::string text =
        "format = 1\nstudy = {id = \"s\", title = \"t\", seed = 1}\ndesign = {repetitions = 1}\n"
        "object = [{name = \"a\", curvature_per_m = 1}]\nfriction = [{name = \"f\", law = "
        "\"frictionless\"}]\n";
    CHECK_THAT(refusal(text), Has("1 pictured object cannot be chosen from: give 2 to 9"));
    CHECK_THAT(refusal("format = 1\nobject = 3\nfriction = [3]\n"),
               Has("with two brackets", "friction 1 is 3"));
}

TEST_CASE("all problems of a stage are said at once, in the order of the file") {
    const std::string said = refusal(edited(kDefaultStudy, {{"gap_s = 1.5", "gap_s = -1"},
                                                            {"rate_hz = 1000", "rate_hz = 10"},
                                                            {"mu_s = 0.7", "mu_s = \"much\""}}));
    CHECK(std::count(said.begin(), said.end(), '\n') == 2);
    CHECK(said.find("rate_hz") < said.find("mu_s"));
    CHECK(said.find("mu_s") < said.find("gap_s"));
}

TEST_CASE("a file that cannot be read says so in the same form") {
    CHECK_THROWS_WITH(
        read_text("/nowhere/p.toml"),
        "/nowhere/p.toml:1:1: cannot be read: No such file or directory; check the path");
    CHECK_THROWS_WITH(read_text("/"), "/:1:1: cannot be read: it is a folder; check the path");
}

TEST_CASE("no file, however broken, does more than be refused line by line") {
    const std::string file = GENERATE(
        as<std::string>{}, "protocols/library/shape_friction.toml", "tests/golden/free_forms.toml",
        "protocols/library/curvature_2afc.toml", "protocols/library/friction_threshold.toml");
    std::string study = palpate::tests::slurp(std::filesystem::path(PALPATE_SOURCE_DIR) / file);
    study += kYounger;
    const int all = cases(250);
    int accepted = 0;
    for (int seed = 0; seed < all; ++seed) {
        Random random(static_cast<std::uint64_t>(seed));
        const std::string text = palpate::tests::broken(study, random);
        CAPTURE(seed, text);
        try {
            const Protocol protocol = parse_protocol(text, "p.toml");
            ++accepted;
            CHECK(parse_protocol(to_toml(protocol), "again.toml") == protocol);
        } catch (const ProtocolError& error) {
            palpate::tests::check_places(error.what());
        }
    }
    // Both ways are taken: most of the first text is comments.
    CHECK(accepted >= all / (file.starts_with("tests") ? 60 : 20));
    CHECK(accepted < all * 9 / 10);
}
