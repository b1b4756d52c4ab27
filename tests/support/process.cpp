#include "tests/support/process.hpp"

#include "tests/support/child.hpp"

namespace palpate::tests {
namespace {

void to_file(const std::string& path, int descriptor) {
    const int fd = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    dup2(fd, descriptor);
    close(fd);
}

/// Memory, where there is enough of it: a test that asks what a disk loses brings its own disk.
std::filesystem::path place_for_folders() {
    constexpr std::uintmax_t kEnough = std::uintmax_t{2} << 30U;  // bytes
    const std::filesystem::path memory = "/dev/shm";
    std::error_code none;
    const auto space = std::filesystem::space(memory, none);
    const bool usable = std::getenv("TMPDIR") == nullptr && !none && space.available >= kEnough &&
                        access(memory.c_str(), W_OK | X_OK) == 0;
    return usable ? memory : std::filesystem::temp_directory_path();
}

}  // namespace

TemporaryFolder::TemporaryFolder() {
    std::string name = (place_for_folders() / "palpate-test-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) {
        throw std::runtime_error("no temporary folder: " + name);
    }
    path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
}

Words TemporaryFolder::names() const {
    Words names;
    for (const auto& entry : std::filesystem::directory_iterator(path_)) {
        names.push_back(entry.path().filename().string());
    }
    std::sort(names.begin(), names.end());
    return names;
}

Process::Process(const Words& command, const Words& environment) {
    std::vector<char*> words;
    for (const std::string& word : command) {
        words.push_back(const_cast<char*>(word.c_str()));  // NOLINT: execvp's old signature
    }
    words.push_back(nullptr);
    const std::string out = folder_.file("out");
    const std::string error = folder_.file("error");
    const pid_t test = getpid();
    pid_ = fork();
    if (pid_ == 0) {
        die_with(test);
        for (const std::string& change : environment) {
            const std::size_t equals = change.find('=');
            if (equals == std::string::npos) {
                unsetenv(change.c_str());
            } else {
                setenv(change.substr(0, equals).c_str(), change.substr(equals + 1).c_str(), 1);
            }
        }
        if (const char* terminal = std::getenv(kTerminal)) {
            setsid();
            dup2(open(terminal, O_RDWR), STDIN_FILENO);  // the first of a session is its own
        }
        to_file(out, STDOUT_FILENO);
        to_file(error, STDERR_FILENO);
        execvp(words[0], words.data());
        _exit(127);
    }
}

Process::~Process() {
    if (!done_) {
        signal(SIGKILL);
        waitpid(pid_, &status_, 0);
    }
}

void Process::signal(int number) const {
    if (!done_) {  // else its number may be another's by now
        kill(pid_, number);
        if (number == SIGSTOP) {
            siginfo_t stopped;
            waitid(P_PID, static_cast<id_t>(pid_), &stopped, WSTOPPED | WEXITED | WNOWAIT);
        }
    }
}

bool Process::running() {
    if (!done_ && waitpid(pid_, &status_, WNOHANG) == pid_) {
        done_ = true;
    }
    return !done_;
}

Finished Process::wait(std::chrono::seconds limit) {
    const auto end = std::chrono::steady_clock::now() + limit;
    while (running()) {
        if (std::chrono::steady_clock::now() > end) {
            signal(SIGKILL);
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return {WIFEXITED(status_) ? WEXITSTATUS(status_) : 128 + WTERMSIG(status_), out(), error()};
}

std::string Process::out() const {
    return slurp(folder_.file("out"));
}

std::string Process::error() const {
    return slurp(folder_.file("error"));
}

bool Process::says(std::string_view text) const {
    return eventually([&] { return out().find(text) != std::string::npos; });
}

bool Process::warns(std::string_view text) const {
    return eventually([&] { return error().find(text) != std::string::npos; });
}

int Process::ended_by(int number) {
    signal(number);
    return wait().code;
}

std::string palpate_program() {
    const char* mutant = std::getenv("PALPATE_TEST_PROGRAM");
    return mutant != nullptr ? mutant : PALPATE_PROGRAM;
}

bool others_load_extension() {
#ifdef PALPATE_SANITIZED
    std::fprintf(stderr, "built with a sanitizer: no other program can load the extension\n");
    return false;
#else
    return true;
#endif
}

Finished palpate_command(const Words& arguments) {
    Words command = command_of(arguments);
    const auto file = std::find(command.begin(), command.end(), "--db");
    const bool given = std::find(command.begin(), command.end(), "--secret") != command.end();
    if (command.size() > 1 && command[1] == "run" && file < command.end() - 1 && !given &&
        !std::filesystem::exists(file[1])) {
        command.insert(command.end(), {"--secret", kRunSecret});
    }
    return Process(command, kNoDisplay).wait();
}

}  // namespace palpate::tests
