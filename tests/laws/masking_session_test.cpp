#include "tests/support/program.hpp"
#include "tests/support/sql_first.hpp"
#include "tests/support/window_session.hpp"

namespace {

/// Four trials with noise and with instructions in two languages, on the pointer.
void write_study(const std::string& file) {
    std::string text = four_trials();
    const std::string table = "[apparatus]\n";
    text.insert(text.find(table) + table.size(), "device = \"mouse\"\n");
    std::ofstream(file) << text
                        << "\n[masking]\nnoise = \"pink\"\nlevel_db = -40\n"
                           "[instructions.en]\nwelcome = \"Feel and choose.\"\n"
                           "[instructions.tr]\nready = \"Tutamağı tutun.\"\n";
}

Words words(const TemporaryFolder& folder, const std::string& kind) {
    return run_words(folder.file("p.toml"), "P1", folder.file("d.sqlite"),
                     {"--device", "mouse", "--kind", kind});
}

}  // namespace

TEST_CASE("a real session that asks for noise begins no trial where there is no sound device") {
    const TemporaryFolder folder;
    write_study(folder.file("p.toml"));
    Process program(command_of(words(folder, "real")),
                    {"SDL_VIDEODRIVER=dummy", "SDL_AUDIODRIVER=none_such"});
    check_end(program.wait(std::chrono::seconds(60)), 1,
              Has("masking noise cannot be played", "--no-sound"));
    CHECK(sql_lines(folder.file("d.sqlite"), "SELECT count(*) FROM session") == "0\n");
}

TEST_CASE("check says how loud the noise is and what the chosen language lacks") {
    const TemporaryFile file("p.toml");
    write_study(file);
    CHECK_THAT(ran({"check", file}).out,
               Has("masking noise: pink at -40 dB re full scale",
                   "[instructions.en] has no ready, [instructions.tr] has"));
}

TEST_CASE("in a real window a trial with noise is recorded, answered and verified", "[window]") {
    const TemporaryFolder folder;
    write_study(folder.file("p.toml"));
    const bool declined = GENERATE(false, true);
    WindowSession session(joined(words(folder, "pilot"), declined ? Words{"--no-sound"} : Words{}),
                          {"SDL_AUDIODRIVER=dummy"}, {});
    session.go_through({"welcome", "ready", "explore"});
    session.press_at("question", "1");
    session.wait_until("SELECT count(*) FROM response", "1");
    session.program().signal(SIGINT);
    ended(session.finish(), 3);
    CHECK_THAT(
        sql_lines(folder.file("d.sqlite"), "SELECT text FROM event WHERE event_kind = 'masking'"),
        Has(declined ? "none: --no-sound was given" : "pink noise at -40 dB re full scale"));
    ran({"verify", folder.file("d.sqlite")});
}
