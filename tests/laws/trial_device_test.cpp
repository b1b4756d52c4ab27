#include <csignal>
#include <thread>

#include <fmt/format.h>

#include "data/store/statement.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/database_edits.hpp"
#include "tests/support/process.hpp"
#include "tests/support/slurp.hpp"

using namespace palpate;
using Catch::Matchers::ContainsSubstring;
using tests::palpate_command;
using tests::TemporaryFolder;

namespace {

std::string ask(const std::string& file, const std::string& query) {
    data::Database database(file, data::Access::read);
    auto row = database.prepare(query);
    return row.step() ? row.text(0) : "";
}

std::vector<std::string> words(const std::string& file,
                               const std::string& device,
                               std::vector<std::string> more = {}) {
    std::vector<std::string> all{"run", "shape_friction_demo", "--participant", "P1",  "--db",
                                 file,  "--headless",          "--device",      device};
    all.insert(all.end(), more.begin(), more.end());
    return all;
}

/// A session on a device that is broken off after its first answer.
void break_off(const std::string& file, const std::string& device) {
    std::vector<std::string> command = words(file, device, {"--speed", "10"});
    command.insert(command.begin(), tests::palpate_program());
    tests::Process process(command, {"DISPLAY", "WAYLAND_DISPLAY"});
    for (int i = 0; i < 20000 && process.running(); ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
        try {
            if (ask(file, "SELECT count(*) > 0 FROM response") == "1") {
                break;
            }
        } catch (const data::StoreError&) {  // it is not there yet
        }
    }
    process.signal(SIGINT);
    CHECK(process.wait().code == 3);
}

}  // namespace

TEST_CASE("each trial has its own device: another one is meant or refused, kept, told and verified",
          "[verify][law]") {
    const TemporaryFolder folder;
    const std::string file = folder.file("d.sqlite");
    break_off(file, "sim");
    const std::string before = ask(file, "SELECT count(*) FROM trial");
    const std::string events = ask(file, "SELECT count(*) FROM event");

    // By accident: refused by name, and nothing is written.
    const auto refused = palpate_command(words(file, "haply-emulator"));
    CHECK(refused.code == 2);
    CHECK_THAT(refused.error, ContainsSubstring("session 1 of P1") &&
                                  ContainsSubstring("was felt on simulated pantograph") &&
                                  ContainsSubstring("would go on with") &&
                                  ContainsSubstring("--other-device"));
    CHECK(ask(file, "SELECT count(*) FROM trial") == before);
    CHECK(ask(file, "SELECT count(*) FROM event") == events);

    // Meant.
    const auto end = palpate_command(words(file, "haply-emulator", {"--other-device"}));
    CAPTURE(end.out, end.error);
    CHECK(end.code == 0);
    CHECK(ask(file, "SELECT count(DISTINCT device) FROM analysis_trial") == "2");
    CHECK(ask(file,
              "SELECT count(*) FROM trial WHERE device LIKE 'simulated%' AND "
              "calibration_sha256 IS NULL") == before);
    CHECK(ask(file, fmt::format("SELECT count(*) FROM trial WHERE trial_id <= {} AND device NOT "
                                "LIKE 'simulated%'",
                                before)) == "0");
    CHECK(palpate_command({"verify", file}).code == 0);

    CHECK_THAT(palpate_command({"summary", file}).out,
               ContainsSubstring("felt on more than one device") &&
                   ContainsSubstring("P1 session 1: " + before + " attempt"));
    REQUIRE(palpate_command({"report", file, "--kind", "simulated", "--simulations", "0", "-o",
                             folder.file("r.html")})
                .code == 0);
    CHECK_THAT(tests::slurp(folder.file("r.html")),
               ContainsSubstring("sessions felt on more than one device"));

    // Who says otherwise of one trial is found out, the seal left aside.
    const std::string last = ask(file, "SELECT max(trial_id) FROM trial");
    {
        data::Database database(file, data::Access::write);
        database
            .prepare("UPDATE trial SET device = 'simulated pantograph' WHERE trial_id = ?1")
            .bind(1, std::string_view(last))
            .run();
    }
    CHECK_THAT(palpate_command({"verify", file}).out, ContainsSubstring("trial.device"));
}
