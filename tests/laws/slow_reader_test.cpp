#include <fcntl.h>
#include <sys/stat.h>

#include "tests/support/child.hpp"
#include "tests/support/program.hpp"
#include "tests/support/sql_first.hpp"

namespace {

/// A pipe with a name and no room left: whoever writes to it waits.
class FullPipe {
public:
    explicit FullPipe(std::string name) : name_(std::move(name)) {
        REQUIRE(mkfifo(name_.c_str(), 0600) == 0);
        fd_ = open(name_.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
        REQUIRE(fd_ >= 0);
        const std::string bytes(4096, '.');
        while (write(fd_, bytes.data(), bytes.size()) > 0) {
        }
    }
    FullPipe(const FullPipe&) = delete;
    FullPipe& operator=(const FullPipe&) = delete;
    ~FullPipe() { close(fd_); }

    [[nodiscard]] const std::string& name() const { return name_; }
    /// All that is in it now.
    [[nodiscard]] std::string taken() const {
        std::string text;
        std::string bytes(4096, '.');
        for (ssize_t got = 0; (got = read(fd_, bytes.data(), bytes.size())) > 0;) {
            text.append(bytes, 0, static_cast<std::size_t>(got));
        }
        return text;
    }

private:
    std::string name_;
    int fd_ = -1;
};

/// A session with its standard output in the file `out`.
std::unique_ptr<Process> run_into(const std::string& out,
                                  const std::string& file,
                                  const std::string& speed = "0") {
    return std::make_unique<Process>(
        joined({"sh", "-c", "out=$1; shift; exec \"$@\" >\"$out\"", "sh", out},
               command_of(demo_words(file, "P1", speed))),
        kNoDisplay);
}

std::string answers(const std::string& file) {
    return sql_now(file, "SELECT count(*) FROM response");
}

}  // namespace

TEST_CASE("a session goes on while nobody reads what it says, and who reads late reads all of it") {
    const TemporaryFolder folder;
    const std::string file = folder.file("d.sqlite");
    const FullPipe pipe(folder.file("pipe"));
    const auto session = run_into(pipe.name(), file);
    REQUIRE(eventually([&] { return answers(file) == "10"; }));
    CHECK_THAT(ran({"status", file}).out, Has("10 of 10 answered"));
    std::string read;
    CHECK(eventually([&] {
        read += pipe.taken();
        return !session->running();
    }));
    read += pipe.taken();
    CHECK(session->wait().code == 0);
    CHECK_THAT(read, Has("10 trials", "\n#1 ", "\n#10 ", "Seal ", "Finished."));
}

TEST_CASE("a session ends as it does, and is stopped, whether or not anybody reads what it says") {
    const TemporaryFolder folder;
    const std::string file = folder.file("d.sqlite");
    const FullPipe pipe(folder.file("pipe"));
    const auto session = run_into(pipe.name(), file, "10");
    REQUIRE(eventually([&] { return answers(file) == "2"; }));
    CHECK_THAT(ran({"stop", file}).out, Has("force"));
    session->signal(SIGTERM);
    const std::int64_t asked = monotonic_ns();
    check_end(session->wait(), 3, Has("nobody read standard output", "are lost"));
    CHECK(monotonic_ns() - asked < 5000 * kMillisecond);
    CHECK_THAT(ran({"verify", file}).out, Has("Nothing differs"));
}
