#include <iostream>

#include "tests/bench/commands.hpp"
#include "tests/bench/own_methods.hpp"
#include "tests/bench/peers/peers.hpp"
#include "tests/bench/report.hpp"
#include "tests/support/foot_oracle.hpp"
#include "tests/support/nasty_curves.hpp"

namespace palpate::bench {
namespace {

/// As many as tests/engine/nasty_cases_test.cpp asks.
constexpr std::uint64_t kCases = 9 * tests::kNastyRound;
constexpr unsigned kPatience = 10;  ///< s, for one answer

struct Case {
    tests::NastyCase nasty;
    long double exact = 0.0L;  ///< m
    long double scale = 1.0L;  ///< size of the curve, or the distance if that is larger, m
};

struct Reply {
    double error =
        std::numeric_limits<double>::infinity();  ///< |d - exact| / scale; infinite: none
    double seconds = 0.0;
};

struct Score {
    int no_answer = 0;
    int crashed = 0;  ///< or took longer than kPatience
    int above_1e_6 = 0;
    int above_1e_9 = 0;
    int above_1e_12 = 0;
    int above_16_ulp = 0;
    double worst = 0.0;
    std::uint64_t worst_seed = 0;
    double seconds = 0.0;
    int replies = 0;

    void add(const Reply& reply, std::uint64_t seed) {
        ++replies;
        seconds += reply.seconds;
        no_answer += std::isfinite(reply.error) ? 0 : 1;
        above_1e_6 += reply.error <= 1e-6 ? 0 : 1;
        above_1e_9 += reply.error <= 1e-9 ? 0 : 1;
        above_1e_12 += reply.error <= 1e-12 ? 0 : 1;
        above_16_ulp += reply.error <= 16.0 * std::numeric_limits<double>::epsilon() ? 0 : 1;
        if (std::isfinite(reply.error) && reply.error > worst) {
            worst = reply.error;
            worst_seed = seed;
        }
    }
};

using Maker = std::function<Methods<2>(const Object&)>;

/// One cold query.
Reply ask(const Maker& maker, std::size_t method, const Case& one) {
    Reply reply;
    try {
        const Methods<2> methods = maker({one.nasty.name, {}, {one.nasty.curve}});
        const auto start = std::chrono::steady_clock::now();
        methods[method]->reset(one.nasty.query);
        const double distance = methods[method]->answer(one.nasty.query).distance;
        reply.seconds = seconds_since(start);
        reply.error = static_cast<double>(std::fabs(distance - one.exact) / one.scale);
    } catch (...) {  // the libraries' own types
    }
    return reply;
}

/// All cases in a child, since libraries crash and loop on some; after each death a new one goes
/// on.
Score score_of(const Maker& maker, std::size_t method, const std::vector<Case>& cases) {
    Score score;
    std::size_t next = 0;
    while (next < cases.size()) {
        std::array<int, 2> pipe_ends{};
        if (pipe(pipe_ends.data()) != 0) {
            throw std::runtime_error("no pipe");
        }
        const pid_t child = fork();
        if (child < 0) {
            throw std::runtime_error("no child process");
        }
        if (child == 0) {
            const int nowhere = open("/dev/null", O_WRONLY);  // SISL tells of every error
            dup2(nowhere, STDOUT_FILENO);
            dup2(nowhere, STDERR_FILENO);
            for (; next < cases.size(); ++next) {
                alarm(kPatience);
                const Reply reply = ask(maker, method, cases[next]);
                if (write(pipe_ends[1], &reply, sizeof reply) != sizeof reply) {
                    break;
                }
            }
            _exit(0);
        }
        close(pipe_ends[1]);
        Reply reply;
        while (next < cases.size() && read(pipe_ends[0], &reply, sizeof reply) == sizeof reply) {
            score.add(reply, cases[next].nasty.seed);
            ++next;
        }
        close(pipe_ends[0]);
        waitpid(child, nullptr, 0);
        if (next < cases.size()) {
            ++score.crashed;
            score.add({}, cases[next].nasty.seed);
            ++next;
        }
    }
    return score;
}

std::vector<Case> all_cases() {
    std::vector<Case> cases;
    for (std::uint64_t seed = 0; seed < kCases; ++seed) {
        Case one{.nasty = tests::nasty_case(seed)};
        const tests::FootOracle oracle(one.nasty.curve);
        one.exact = oracle.closest(one.nasty.query).distance;
        const long double size = std::max(oracle.size(), one.exact);
        one.scale = size > 0.0L ? size : 1.0L;
        cases.push_back(std::move(one));
    }
    return cases;
}

}  // namespace

int nasty_command(Words words) {
    const bool with_peers = words.flag("--peers");
    const std::string csv_name = words.value("--csv");
    words.finish();
    Output csv(csv_name,
               "machine,method,asked,no_answer,crashed,above_1e_6,above_1e_9,above_1e_12,"
               "above_16_ulp,worst,worst_seed,mean_us\n");
    const std::vector<Case> cases = all_cases();
    std::vector<Maker> makers{any_curve_methods};
    if (with_peers) {
        makers.emplace_back(sisl_methods);
        makers.emplace_back(occt_methods);
    }

    std::cout << machine() << '\n'
              << cases.size()
              << " nasty queries, each cold; errors relative to max(size of the curve, distance)\n";
    std::printf("%-34s %9s %9s %7s %7s %7s %7s %9s %9s %9s\n", "method", "no answer", "(crashed)",
                "> 1e-6", "> 1e-9", "> 1e-12", "> 16ulp", "worst", "its seed", "mean us");
    for (const Maker& maker : makers) {
        const Methods<2> named = maker(contact_objects().front());
        for (std::size_t i = 0; i < named.size(); ++i) {
            std::cout.flush();
            std::fflush(stdout);
            const Score s = score_of(maker, i, cases);
            const double each = 1e6 * s.seconds / (s.replies - s.crashed);
            std::printf("%-34s %9d %9d %7d %7d %7d %7d %9.1e %9llu %9.2f\n",
                        named[i]->name().c_str(), s.no_answer, s.crashed, s.above_1e_6,
                        s.above_1e_9, s.above_1e_12, s.above_16_ulp, s.worst,
                        static_cast<unsigned long long>(s.worst_seed), each);
            csv << '"' << machine() << "\",\"" << named[i]->name() << "\"," << s.replies << ','
                << s.no_answer << ',' << s.crashed << ',' << s.above_1e_6 << ',' << s.above_1e_9
                << ',' << s.above_1e_12 << ',' << s.above_16_ulp << ',' << s.worst << ','
                << s.worst_seed << ',' << each << '\n';
        }
    }
    csv.finish();
    return 0;
}

}  // namespace palpate::bench
