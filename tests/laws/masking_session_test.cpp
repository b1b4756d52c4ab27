#include <csignal>
#include <fstream>
#include <iterator>
#include <thread>

#include "data/store/database.hpp"
#include "data/verify/verify.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/process.hpp"
#include "tests/support/x_hand.hpp"
#include "tests/support/xvfb.hpp"

using namespace palpate;
using Catch::Matchers::ContainsSubstring;
using tests::TemporaryFolder;

namespace {

/// Four trials with noise and with instructions in two languages.
void write_study(const std::string& file) {
    std::ifstream in(PALPATE_SOURCE_DIR "/tests/golden/four_trials.toml");
    std::ofstream(file) << std::string{std::istreambuf_iterator<char>(in), {}}
                        << "\n[masking]\nnoise = \"pink\"\nlevel_db = -40\n"
                           "[instructions.en]\nwelcome = \"Feel and choose.\"\n"
                           "[instructions.tr]\nready = \"Tutamağı tutun.\"\n";
}

std::vector<std::string> words(const TemporaryFolder& folder, const std::string& kind) {
    return {tests::palpate_program(),
            "run",
            folder.file("p.toml"),
            "--participant",
            "P1",
            "--db",
            folder.file("d.sqlite"),
            "--device",
            "mouse",
            "--kind",
            kind};
}

std::string text_of(const TemporaryFolder& folder, const std::string& sql) {
    data::Database database(folder.file("d.sqlite"), data::Access::read);
    auto row = database.prepare(sql);
    std::string text;
    while (row.step()) {
        text += row.text(0) + '\n';
    }
    return text;
}

void pause(double seconds) {
    std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
}

}  // namespace

TEST_CASE("a real session that asks for noise begins no trial where there is no sound device",
          "[sound][law]") {
    const TemporaryFolder folder;
    write_study(folder.file("p.toml"));
    tests::Process program(words(folder, "real"),
                           {"SDL_VIDEODRIVER=dummy", "SDL_AUDIODRIVER=none_such"});
    const tests::Finished end = program.wait(std::chrono::seconds(60));
    CAPTURE(end.out, end.error);
    CHECK(end.code == 1);
    CHECK_THAT(end.error, ContainsSubstring("masking noise cannot be played"));
    CHECK_THAT(end.error, ContainsSubstring("--no-sound"));
    CHECK(text_of(folder, "SELECT count(*) FROM session") == "0\n");
}

TEST_CASE("check says how loud the noise is and what the chosen language lacks", "[sound]") {
    const TemporaryFolder folder;
    write_study(folder.file("p.toml"));
    const tests::Finished said = tests::palpate_command({"check", folder.file("p.toml")});
    CAPTURE(said.error);
    CHECK(said.code == 0);
    CHECK_THAT(said.out, ContainsSubstring("masking noise: pink at -40 dB re full scale"));
    CHECK_THAT(said.out,
               ContainsSubstring("[instructions.en] has no ready, [instructions.tr] has"));
}

TEST_CASE("in a real window a trial with noise is recorded, answered and verified",
          "[sound][window][law]") {
    const tests::Xvfb screen(1280, 800);
    tests::XHand hand(screen.display());
    const TemporaryFolder folder;
    write_study(folder.file("p.toml"));
    const bool declined = GENERATE(false, true);
    std::vector<std::string> all = words(folder, "pilot");
    if (declined) {
        all.emplace_back("--no-sound");
    }
    tests::Process program(
        all, {"DISPLAY=" + screen.display(), "SDL_VIDEODRIVER=x11", "SDL_AUDIODRIVER=dummy",
              "WAYLAND_DISPLAY", "ASAN_OPTIONS=detect_leaks=0",
              "TSAN_OPTIONS=suppressions=" PALPATE_SOURCE_DIR "/tests/support/tsan.supp"});
    static_cast<void>(hand.wait_for_window("palpate", 20.0));
    const auto answers = [&] {
        return std::ifstream(folder.file("d.sqlite")).good()
                 ? text_of(folder, "SELECT count(*) FROM response")
                 : "0\n";
    };
    pause(0.5);
    for (int i = 0; i < 60 && answers() == "0\n"; ++i) {  // welcome, ready, done: whatever is shown
        hand.key("space");
        pause(0.8);
        hand.key("1");
        pause(0.2);
    }
    program.signal(SIGINT);
    const tests::Finished end = program.wait(std::chrono::seconds(20));
    CAPTURE(end.out, end.error);
    CHECK(end.code == 3);
    CHECK(answers() != "0\n");
    CHECK_THAT(text_of(folder, "SELECT text FROM event WHERE kind = 'masking'"),
               ContainsSubstring(declined ? "none: --no-sound was given"
                                          : "pink noise at -40 dB re full scale"));
    data::Database database(folder.file("d.sqlite"), data::Access::read);
    CHECK(data::verify(database).count(data::FindingKind::differs) == 0);
}
