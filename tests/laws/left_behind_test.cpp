#include "tests/support/catch.hpp"
#include "tests/support/child.hpp"
#include "tests/support/test_text.hpp"
#include "tests/support/window_session.hpp"

namespace {

/// In the environment of the test below, and so of all that descends from it.
constexpr const char* kMark = "PALPATE_TEST_MARK";

/// Command lines of the processes, this one aside, whose environment holds `mark`.
Words marked(const std::string& mark) {
    Words found;
    for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
        const std::string id = entry.path().filename().string();
        if (id.find_first_not_of("0123456789") != std::string::npos ||
            id == fmt::format("{}", getpid())) {
            continue;
        }
        if (slurp(entry.path() / "environ").find(mark) != std::string::npos) {
            found.push_back(slurp(entry.path() / "cmdline"));
        }
    }
    return found;
}

}  // namespace

TEST_CASE("a test that is killed leaves no process behind", "[window]") {
    const TemporaryFolder folder;
    const std::string mark = fmt::format("{}={:08x}", kMark, std::random_device{}());
    // The test program itself, in a session in a window with board, guard and screen.
    Process test({std::filesystem::read_symlink("/proc/self/exe").string(), "[.endless]"},
                 {mark, "PALPATE_TEST_FOLDER=" + folder.path().string()});
    REQUIRE(eventually([&] { return std::filesystem::exists(folder.file("begun")); }));
    CHECK(marked(mark).size() >= 4);  // the test, Xvfb, palpate, its guard

    test.signal(SIGKILL);
    test.wait();
    Words left;
    eventually([&] { return (left = marked(mark)).empty(); });
    CAPTURE(left);
    CHECK(left.empty());
}

TEST_CASE("what the test above kills: a session that nobody ends", "[.endless]") {
    const char* name = std::getenv("PALPATE_TEST_FOLDER");
    REQUIRE(name != nullptr);
    const std::filesystem::path folder = name;
    WindowSession session({"run", kFourTrials, "--participant", "P1", "--db",
                           (folder / "d.sqlite").string(), "--device", "haply-emulator"});
    session.go_through({"welcome", "ready"});
    session.wait_for_screen("explore");
    std::ofstream(folder / "begun") << '\n';
    for (;;) {
        std::this_thread::sleep_for(std::chrono::hours(1));
    }
}
