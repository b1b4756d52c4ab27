#include <set>

#include "protocols/file/procedure_file.hpp"
#include "tests/support/placed_lines.hpp"
#include "tests/support/test_text.hpp"

using namespace palpate::protocols;

namespace {

std::string file_of(const std::string& name) {
    return test_text("procedures/" + name + ".toml");
}

const std::string kQuestPlus = file_of("quest_plus");
const std::string kStaircases = file_of("staircases");
const std::string kPsi = file_of("psi");
const std::vector<std::string> kAll{
    kQuestPlus,          kStaircases,     kPsi, file_of("identification"), file_of("covariate"),
    file_of("constant"), file_of("quest")};

std::string problems(std::string_view text) {
    return refusal_of<ProtocolError>([&] { return parse_procedure(text, "p.toml"); });
}

}  // namespace

TEST_CASE("every kind of procedure file is read") {
    for (const std::string_view text : kAll) {
        CAPTURE(text);
        CHECK(problems(text) == "accepted");
    }
    const Procedure file = parse_procedure(kStaircases, "p.toml");
    CHECK(file.estimates()[0].name == "low");
    CHECK(file.estimates()[1].name == "staircase_2");
    CHECK(parse_procedure(file_of("identification"), "p.toml").outcomes() == 5);
    CHECK(parse_procedure(file_of("covariate"), "p.toml").stimulus_names() ==
          std::vector<std::string>{"stimulus", "covariate"});
    CHECK(parse_procedure(kPsi, "p.toml").estimates()[1].name == "log10_slope");
}

TEST_CASE("a procedure file gives what the same spec gives") {
    Procedure read = parse_procedure(kStaircases, "p.toml");
    Procedure made(std::vector<StaircaseSpec>{{.name = "low",
                                               .start = 4.0,
                                               .steps_up = {2.0, 1.0},
                                               .steps_down = {2.0, 1.0},
                                               .fast_start = true,
                                               .lowest = 0.0,
                                               .highest = 20.0,
                                               .reversals = 8,
                                               .average = 6},
                                              {.name = "staircase_2",
                                               .start = 16.0,
                                               .down = 1,
                                               .steps_down = {(1.0 - 0.75) / 0.75},
                                               .trials = 30}},
                   Pcg32(0x0011223344556677, 0x8899aabbccddeeff));
    for (std::size_t i = 0; i < 30; ++i) {
        REQUIRE(read.state_hash() == made.state_hash());
        REQUIRE(read.next() == made.next());
        read.update(read.next(), i * i % 3 == 1 ? 0 : 1);
        made.update(made.next(), i * i % 3 == 1 ? 0 : 1);
    }
}

TEST_CASE("a level given by steps is the decimal number that one would write") {
    const std::string text =
        replaced(file_of("constant"), "[1, 2, 3, 4]", "{ from = -0.3, to = 0.6, step = 0.1 }");
    Procedure read = parse_procedure(text, "p.toml");
    std::set<double> levels;
    for (; !read.finished(); read.update(read.next(), 0)) {
        levels.insert(read.next().at(0));
    }
    CHECK(levels == std::set{-0.3, -0.2, -0.1, 0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6});
}

TEST_CASE("every key of the reference is read by some file, and each other one refused") {
    std::string all;
    for (const std::string_view text : kAll) {
        all += text;
    }
    const std::string reference = procedure_key_reference();
    for (const char* table : {"procedure", "stream", "constant", "staircase", "quest", "model",
                              "stimuli", "parameters"}) {
        for (const Key& key : procedure_keys(table)) {
            CAPTURE(table, key.name);
            CHECK(reference.find(std::string(key.name) + " ") != std::string::npos);
            CHECK_FALSE(key.meaning.empty());
            const bool used = all.find(std::string(key.name) + " =") != std::string::npos;
            CHECK((used || key.name == "sd"));  // tested below
        }
    }
    std::string text = replaced(kPsi, "kind = \"psi\"", "kind = \"quest_plus\"");
    text = replaced(text, "family = \"normal\"", "family = \"normal\"\nslope_as = \"sd\"");
    CHECK(problems(replaced(text, "log10_slope = { from = -0.5,", "sd = { from = 0.5,")) ==
          "accepted");
    // An unknown key in every table of every file.
    for (const std::string_view file : kAll) {
        for (std::size_t at = file.find("\n["); at != std::string_view::npos;
             at = file.find("\n[", at + 1)) {
            const std::size_t end = file.find('\n', at + 1);
            const std::string changed =
                std::string(file.substr(0, end)) + "\nbogus = 1" + std::string(file.substr(end));
            CAPTURE(changed);
            CHECK_THAT(problems(changed), Has("unknown key \"bogus\""));
        }
    }
}

TEST_CASE("what is wrong with a procedure file is said with place and remedy") {
    for (const auto& row : test_rows("procedure_problems.tsv")) {
        CAPTURE(row);
        CHECK_THAT(problems(replaced(file_of(row.at(0)), row.at(1), row.at(2))), Has(row.at(3)));
    }
    CHECK_THAT(problems(replaced(kQuestPlus, "\"quest_plus\"", "\"adaptive\"")),
               EndsWith("\"psi\" or \"quest_plus\""));  // it is needed: not to delete
    CHECK_THAT(problems("format = 1\n[procedure]\nkind = \"staircase\"\n"),
               Has("write each as a table [[staircase]]"));
    CHECK_THAT(problems("format = 1\nprocedure = 3\n"), Has("write it as a table"));
    CHECK_THAT(problems("format = \n"), Has("not TOML"));
}

TEST_CASE("no procedure file, however broken, does more than be refused line by line") {
    int accepted = 0;
    for (std::uint64_t seed = 0; seed < 3000; ++seed) {
        Random random(seed);
        const std::string text = broken(std::string(kAll[seed % kAll.size()]), random, 30);
        CAPTURE(seed, text);
        try {
            Procedure procedure = parse_procedure(text, "p.toml");
            ++accepted;
            if (!procedure.finished()) {
                procedure.update(procedure.next(), 1);
            }
        } catch (const ProtocolError& error) {
            check_places(error.what());
        } catch (const std::invalid_argument& error) {
            // A response that a strange but possible model forbids.
            CHECK_THAT(error.what(), Has("impossible"));
        }
    }
    CHECK(accepted > 100);
    CHECK(accepted < 2700);
}
