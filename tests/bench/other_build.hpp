#pragma once

#include "tests/bench/courses.hpp"

namespace palpate::bench {

/// A method in a table of `contact`.
struct Place {
    std::string object;
    std::string path;
    std::string method;
};

/// What counts instructions on this machine.
struct Counting {
    enum class By : std::uint8_t { nobody, kernel, callgrind } by = By::nobody;
    std::string sentence;  ///< for people: which, or why none
};

[[nodiscard]] Counting counting();

/// palpate_bench as a child process, this build or another, that measures what it is asked.
class OtherBuild {
public:
    /// @param counts  it will only be asked for instructions: by callgrind if that is what counts
    OtherBuild(const std::string& binary, const CoursePlan& plan, Counting::By counts);
    OtherBuild(const OtherBuild&) = delete;
    OtherBuild& operator=(const OtherBuild&) = delete;
    ~OtherBuild();

    /// One pass over the path. @return ns a tick of each round, as Passes::ns; none: it has no such
    /// method
    [[nodiscard]] std::vector<double> pass(const Place& place, std::size_t rounds);
    /// A tick, over the path's first 5 s; 0 if it has no such method.
    [[nodiscard]] double instructions(const Place& place);

private:
    std::string ask(const std::string& what, const Place& place);

    std::string binary_;
    std::filesystem::path folder_;  ///< of what callgrind writes; or empty
    int dumps_ = 0;
    pid_t pid_ = -1;
    std::FILE* to_ = nullptr;
    std::FILE* from_ = nullptr;
};

/// What such a child does: one line of answer to each line on standard input, to its end.
void answer_requests(const CoursePlan& plan);

}  // namespace palpate::bench
