#pragma once

#include <nlohmann/json.hpp>

#include "data/csv/json_text.hpp"
#include "data/store/database.hpp"
#include "ui/live/live_segment.hpp"
#include "tests/support/browser.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/child.hpp"
#include "tests/support/test_text.hpp"

namespace palpate::tests {

/// How often: as the environment's `name` says, else `usual`.
[[nodiscard]] inline int times(const char* name, int usual) {
    const char* asked = std::getenv(name);
    return asked != nullptr ? std::stoi(asked) : usual;
}

/// Asks how many events of a kind there are.
[[nodiscard]] inline std::string events_of(const std::string& kind) {
    return "SELECT count(*) FROM event WHERE event_kind = '" + kind + "'";
}

/// `palpate run` without a window, slow enough to be looked at; the study is longer than any test.
/// kFourTrials is short.
class ShownSession {
public:
    /// @param speed  and what else is said to `run`
    explicit ShownSession(const std::string& protocol = "shape_friction",
                          const Words& speed = {"2"})
        : file(folder_.file("d.sqlite")), program(command(protocol, speed)) {
        REQUIRE(eventually([&] {
            auto all = ui::running_sessions(file);
            if (!all.empty()) {
                shown = std::move(all.front());
            }
            return shown.reader != nullptr;
        }));
    }
    [[nodiscard]] data::Json ask(const data::Json& line) const {
        return data::Json::parse(ui::ask_session(shown.name, line.dump()).line, nullptr, false);
    }
    /// Empty before it shows any.
    [[nodiscard]] data::Json state() const {
        const auto state = shown.reader->state();
        return state ? data::Json::parse(state->json, nullptr, false) : data::Json::object();
    }
    [[nodiscard]] bool comes_to(const std::string& phase) const {
        return eventually([&] { return state().value("phase", "") == phase; });
    }
    [[nodiscard]] std::string kept(const std::string& sql) const {
        data::Database database(file, data::Access::read);
        data::Statement row = database.prepare(sql);
        return row.step() ? row.text(0) : "nothing";
    }
    [[nodiscard]] bool keeps(const std::string& sql, const std::string& value) const {
        return eventually([&] { return kept(sql) == value; });
    }

private:
    [[nodiscard]] Words command(const std::string& protocol, const Words& more) const {
        return joined({palpate_program(), "run", protocol, "--participant", "P1", "--db", file,
                       "--headless", "--operator", "Ada", "--secret", kRunSecret, "--speed"},
                      more);
    }
    TemporaryFolder folder_;

public:
    std::string file;
    Process program;
    ui::RunningSession shown;
};

/// Whoever was started by a process, and is `palpate console`; 0: nobody.
[[nodiscard]] inline pid_t console_of(pid_t parent) {
    for (const pid_t child : children_of(parent)) {
        if (slurp(fmt::format("/proc/{}/cmdline", child)).find("console") != std::string::npos) {
            return child;
        }
    }
    return 0;
}

/// It ended, whether or not anybody asked how.
[[nodiscard]] inline bool has_ended(pid_t process) {
    return kill(process, 0) != 0 ||
           slurp("/proc/" + std::to_string(process) + "/stat").find(") Z ") != std::string::npos;
}

/// A browser with the cookie of a page, once its server says where it is.
[[nodiscard]] inline Browser browser_of(const Process& server) {
    REQUIRE(server.says("\nCtrl+C"));
    Browser browser(server.out());
    browser.trade();
    return browser;
}

/// `palpate console` on a session, and a browser that has its address.
struct Console {
    explicit Console(const ShownSession& session)
        : program({palpate_program(), "console", session.file}) {
        REQUIRE(program.says("\nCtrl+C"));
        browser = std::make_unique<Browser>(program.out());
    }
    [[nodiscard]] std::unique_ptr<HttpLine> stream(const std::string& query = {}) const {
        return browser->stream(query);
    }
    Process program;
    std::unique_ptr<Browser> browser;
};

}  // namespace palpate::tests
