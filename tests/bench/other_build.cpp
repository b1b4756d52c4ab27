#include "tests/bench/other_build.hpp"

#include "tests/support/child.hpp"

namespace palpate::bench {
namespace {

/// @param in, out  become standard input and output
void become(std::vector<std::string> words, int in, int out) {
    std::vector<char*> arguments;
    for (std::string& word : words) {
        arguments.push_back(word.data());
    }
    arguments.push_back(nullptr);
    dup2(in, STDIN_FILENO);
    dup2(out, STDOUT_FILENO);
    execvp(arguments[0], arguments.data());
    _exit(127);
}

}  // namespace

OtherBuild::OtherBuild(const std::string& binary, const CoursePlan& plan, Counting::By counts)
    : binary_(binary) {
    std::vector<std::string> words{binary,
                                   "contact",
                                   "--answer",
                                   "--objects",
                                   plan.objects,
                                   "--seconds",
                                   fmt::format("{}", plan.seconds)};
    if (plan.peers) {
        words.emplace_back("--peers");
    }
    if (counts == Counting::By::callgrind) {
        std::string name = (std::filesystem::temp_directory_path() / "palpate-bench-XXXXXX");
        folder_ = mkdtemp(name.data());
        const std::string file = folder_ / "count";
        words.insert(
            words.begin(),
            {"valgrind", "-q", "--tool=callgrind", "--toggle-collect=*palpate_bench_counted*",
             "--dump-after=*palpate_bench_done*", "--callgrind-out-file=" + file});
    }
    std::array<int, 2> to{};
    std::array<int, 2> from{};
    if (pipe2(to.data(), O_CLOEXEC) != 0 || pipe2(from.data(), O_CLOEXEC) != 0) {
        throw std::runtime_error("no pipe to another build");
    }
    std::signal(SIGPIPE, SIG_IGN);
    pid_ = tests::in_a_child([&] { become(std::move(words), to[0], from[1]); });
    close(to[0]);
    close(from[1]);
    to_ = fdopen(to[1], "w");
    from_ = fdopen(from[0], "r");
}

OtherBuild::~OtherBuild() {
    std::fclose(to_);  // which ends it
    std::fclose(from_);
    waitpid(pid_, nullptr, 0);
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
}

std::string OtherBuild::ask(const std::string& what, const Place& place) {
    fmt::print(to_, "{}\t{}\t{}\t{}\n", what, place.object, place.path, place.method);
    std::fflush(to_);
    std::string line;
    for (int c = std::getc(from_); c != '\n'; c = std::getc(from_)) {
        if (c == EOF) {
            throw std::runtime_error(
                binary_ + " gives no answer: name a palpate_bench that knows contact --answer");
        }
        line += static_cast<char>(c);
    }
    return line;
}

std::vector<double> OtherBuild::pass(const Place& place, std::size_t rounds) {
    std::istringstream words(ask(fmt::format("pass {}", rounds), place));
    std::vector<double> ns;
    for (std::string word; words >> word && word != "none";) {
        ns.push_back(std::stod(word));  // "nan", too
    }
    return ns;
}

double OtherBuild::instructions(const Place& place) {
    double ticks = 0.0;
    double count = 0.0;
    std::istringstream(ask("count", place)) >> ticks >> count;
    for (;; ++dumps_) {  // callgrind's, if it is that
        std::ifstream dump(folder_ / fmt::format("count.{}", dumps_ + 1));
        if (folder_.empty() || !dump) {
            break;
        }
        for (std::string line; std::getline(dump, line);) {
            if (line.rfind("summary: ", 0) == 0) {
                count += std::stod(line.substr(9));
            }
        }
    }
    return ticks > 0.0 ? count / ticks : 0.0;
}

}  // namespace palpate::bench
