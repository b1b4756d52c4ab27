#include "data/extension/sample_module.hpp"
#include "data/statistics/distributions.hpp"
#include "data/statistics/information.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/studies.hpp"

namespace {

/// A database with the functions, and the first value of a query.
class Asked {
public:
    Asked() { REQUIRE(data::add_extension(database_.handle()) == 0); }
    double real(const std::string& sql) {
        data::Statement row = database_.prepare(sql);
        REQUIRE(row.step());
        REQUIRE(row.type(0) == 2);
        return row.real(0);
    }
    bool null(const std::string& sql) {
        data::Statement row = database_.prepare(sql);
        return row.step() && row.null(0);
    }
    std::string error(const std::string& sql) {
        return refusal_of<data::StoreError>([&] { return database_.first(sql); });
    }

private:
    NewDatabase database_;
};

/// P(X >= k) of a binomial, added up term by term.
long double upper_tail(int k, int n, long double p) {
    long double sum = 0.0L;
    for (int i = k; i <= n; ++i) {
        long double term = 1.0L;
        for (int j = 1; j <= i; ++j) {
            term *= static_cast<long double>(n - i + j) / j * p;
        }
        for (int j = 0; j < n - i; ++j) {
            term *= 1.0L - p;
        }
        sum += term;
    }
    return sum;
}

/// Owen's T by Simpson's rule.
double owens_t(double h, double a) {
    constexpr int kPieces = 2000;
    double sum = 0.0;
    for (int i = 0; i <= kPieces; ++i) {
        const double x = a * i / kPieces;
        const double weight = i == 0 || i == kPieces ? 1.0 : i % 2 == 1 ? 4.0 : 2.0;
        sum += weight * std::exp(-0.5 * h * h * (1.0 + x * x)) / (1.0 + x * x);
    }
    return sum * a / kPieces / 3.0 / (2.0 * std::numbers::pi);
}

double phi(double z) {
    return 0.5 * std::erfc(-z / std::numbers::sqrt2);
}

}  // namespace

// R. G. Newcombe, Statistics in Medicine 17:857 (1998), table I: methods 3 (score) and 5 (exact).
TEST_CASE("intervals of shares are those of Newcombe's table") {
    struct Interval {
        int k;
        int n;
        double wilson_low, wilson_high, exact_low, exact_high;
    };
    const auto row = GENERATE(values<Interval>({{81, 263, .2553, .3662, .2527, .3676},
                                                {15, 148, .0624, .1605, .0578, .1617},
                                                {0, 20, .0000, .1611, .0000, .1684},
                                                {1, 29, .0061, .1718, .0009, .1776}}));
    Asked asked;
    const auto value = [&](const std::string& name) {
        return asked.real(fmt::format("SELECT {}({}, {})", name, row.k, row.n));
    };
    CAPTURE(row.k, row.n);
    CHECK(value("wilson_low") == Approx(row.wilson_low).margin(5.1e-5));
    CHECK(value("wilson_high") == Approx(row.wilson_high).margin(5.1e-5));
    CHECK(value("clopper_pearson_low") == Approx(row.exact_low).margin(5.1e-5));
    CHECK(value("clopper_pearson_high") == Approx(row.exact_high).margin(5.1e-5));
}

TEST_CASE(
    "at the ends of an exact interval the binomial tails are what is left of the confidence") {
    const auto seed = GENERATE(seeds(200U));
    Random random(seed);
    const int n = 1 + random.below(80);
    const int k = random.below(n + 1);
    const double confidence = random.in(0.5, 0.999);
    CAPTURE(seed, k, n, confidence);
    const data::Interval interval = data::clopper_pearson(k, n, confidence);
    const double tail = 0.5 * (1.0 - confidence);
    CHECK(((k == 0 && interval.low == 0.0) ||
           static_cast<double>(upper_tail(k, n, interval.low)) == Approx(tail).epsilon(1e-10)));
    CHECK(((k == n && interval.high == 1.0) ||
           static_cast<double>(1.0L - upper_tail(k + 1, n, interval.high)) ==
               Approx(tail).epsilon(1e-10)));
}

TEST_CASE("d' gives back the share that it came from, by closed forms for two and three") {
    const auto seed = GENERATE(seeds(40U));
    Random random(seed);
    const double d = random.in(-1.0, 4.0);
    CAPTURE(seed, d);
    CHECK(data::share_correct(d, 2) == Approx(phi(d / std::numbers::sqrt2)).epsilon(1e-12));
    const double h = d / std::numbers::sqrt2;  // D. B. Owen, Ann. Math. Stat. 27:1075 (1956)
    CHECK(data::share_correct(d, 3) ==
          Approx(phi(h) - 2.0 * owens_t(h, 1.0 / std::numbers::sqrt3)).epsilon(1e-11));
    const int n = 2 + random.below(300);
    const int hits = 1 + random.below(n - 1);
    const int m = 2 + random.below(7);
    CAPTURE(hits, n, m);
    CHECK(data::share_correct(data::d_prime(hits, n, m), m) ==
          Approx(static_cast<double>(hits) / n).epsilon(1e-10));
    CHECK(data::share_correct(0.0, m) == Approx(1.0 / m).epsilon(1e-13));
}

TEST_CASE("d' gives back a share next to one or none, too, of up to a million answers") {
    EACH(n, 100, 10'000, 100'000, 1'000'000);
    EACH(m, 3, 8, 100, 1000);
    const double end = 0.5 / n;
    CHECK(1.0 - data::share_correct(data::d_prime(n, n, m), m) == Approx(end).epsilon(1e-6));
    CHECK(data::share_correct(data::d_prime(0, n, m), m) == Approx(end).epsilon(1e-6));
}

TEST_CASE("the functions of SQL say what they cannot do, and NULL for NULL") {
    Asked asked;
    CHECK_THAT(asked.error("SELECT wilson_low(5, 3)"), Has("0 <= k <= n"));
    CHECK_THAT(asked.error("SELECT clopper_pearson_high(1, 2.5)"), Has("whole"));
    CHECK_THAT(asked.error("SELECT wilson_high(1, 3, 95)"), Has("0.95"));
    CHECK_THAT(asked.error("SELECT d_prime(1, 3, 1)"), Has("2 to 1000"));
    CHECK_THAT(asked.error("SELECT probit(1.5)"), Has("1.5"));
    CHECK_THAT(asked.error("SELECT share(column1) FROM (VALUES (1), (0.5))"),
               Has("0.5 is neither 0 nor 1"));
    CHECK_THAT(asked.error("SELECT probit('often')"), Has("give a number"));
    CHECK_THAT(asked.error("SELECT normal_cdf(x'31')"), Has("give a number"));
    CHECK_THAT(asked.error("SELECT geometric_mean(0)"), Has("above 0"));
    CHECK_THAT(asked.error("SELECT median('abc')"), Has("abc"));
    CHECK_THAT(asked.error("SELECT quantile(column1, column2) FROM (VALUES (1, 0.2), (2, 0.3))"),
               Has("one share"));
    CHECK_THAT(asked.error("SELECT mutual_information('a', 'b', -1)"), Has("n is -1"));
    for (const char* sql : {"SELECT wilson_low(NULL, 3)", "SELECT d_prime(0, 0, 2)",
                            "SELECT probit(NULL)", "SELECT median(NULL)", "SELECT stddev_samp(1)",
                            "SELECT share(column1) FROM (VALUES (NULL))"}) {
        CAPTURE(sql);
        CHECK(asked.null(sql));
    }
    CHECK(asked.real("SELECT wilson_low(0, 0)") == 0.0);
    CHECK(asked.real("SELECT probit(0.975)") == Approx(1.959963984540054).epsilon(1e-14));
    CHECK(asked.real("SELECT normal_cdf(1.959963984540054)") == Approx(0.975).epsilon(1e-14));
    CHECK(asked.real("SELECT probit(0.5)") == 0.0);
    CHECK(asked.real("SELECT d_prime(5, 10, 2)") == 0.0);
    CHECK(asked.real("SELECT d_prime(10, 10, 2)") ==
          Approx(std::numbers::sqrt2 * asked.real("SELECT probit(0.95)")).epsilon(1e-12));
}

TEST_CASE("aggregates are those of sorted and added-up numbers") {
    const auto seed = GENERATE(seeds(60U));
    Random random(seed);
    Asked asked;
    std::vector<double> x(static_cast<std::size_t>(2 + random.below(40)));
    std::string rows;
    for (double& value : x) {
        value = random.in(0.1, 9.0);
        rows += fmt::format("{}({})", rows.empty() ? "" : ", ", value);
    }
    const double p = random.coin() ? random.in(0.0, 1.0) : random.below(3) * 0.5;
    const auto ask = [&](const std::string& what) {
        return asked.real(fmt::format("SELECT {} FROM (VALUES {}, (NULL))", what, rows));
    };
    std::sort(x.begin(), x.end());
    const auto quantile =
        [&x](double share) {  // Hyndman & Fan, Am. Statistician 50:361 (1996), type 7
            const double h = share * static_cast<double>(x.size() - 1);
            const auto low = static_cast<std::size_t>(h);
            const auto high = std::min(low + 1, x.size() - 1);
            return x[low] + (h - static_cast<double>(low)) * (x[high] - x[low]);
        };
    const auto n = static_cast<double>(x.size());
    double sum = 0.0;
    double logs = 0.0;
    double above = 0.0;
    for (const double value : x) {
        sum += value;
        logs += std::log(value);
        above += value > 4.0 ? 1.0 : 0.0;
    }
    double squares = 0.0;
    for (const double value : x) {
        squares += (value - sum / n) * (value - sum / n);
    }
    CAPTURE(seed, p, rows);
    CHECK(ask("median(column1)") == Approx(quantile(0.5)).epsilon(1e-14));
    CHECK(ask(fmt::format("quantile(column1, {})", p)) == Approx(quantile(p)).epsilon(1e-14));
    CHECK(ask("geometric_mean(column1)") == Approx(std::exp(logs / n)).epsilon(1e-13));
    CHECK(ask("stddev_samp(column1)") == Approx(std::sqrt(squares / (n - 1.0))).epsilon(1e-12));
    CHECK(ask("share(column1 > 4)") == Approx(above / n).epsilon(1e-14));
}

TEST_CASE("over any window a function says to the bit what the rows of its frame say as a group") {
    const auto seed = GENERATE(seeds(25U));
    Random random(seed);
    const int before = random.below(6);
    const int after = random.below(6) - 2;
    CAPTURE(seed, before, after);
    Asked asked;
    std::string values;
    for (int i = 0; i < 60; ++i) {
        values += fmt::format("{}({}, {}, {}, '{}')", i == 0 ? "" : ", ", i, i % 3,
                              random.below(8) == 0 ? std::string("NULL")
                                                   : fmt::format("{}", random.decade(-3.0, 3.0)),
                              "abc"[random.below(3)]);
    }
    for (const std::string function :
         {"median(x)", "quantile(x, 0.3)", "geometric_mean(x)", "stddev_samp(x)", "share(x > 1)",
          "people_mean_low(x)", "people_mean_high(x)", "people_share_low(x / 1001)",
          "people_share_high(x / 1001)", "mutual_information(c, x > 1)",
          "mutual_information(c, x > 1, 2)", "mutual_information_miller_madow(c, x > 1)"}) {
        CAPTURE(function);
        const std::string frame =
            fmt::format("ROWS BETWEEN {} PRECEDING AND {}", before,
                        after < 0 ? fmt::format("{} PRECEDING", std::min(before, -after))
                                  : fmt::format("{} FOLLOWING", after));
        const std::string ends =
            fmt::format("a.i >= o.i - {} AND a.i <= o.i + {}", before, std::max(after, -before));
        const auto differing = [&](const std::string& over, const std::string& where) {
            return asked.real(fmt::format(
                "WITH t (n, p, x, c) AS (VALUES {}), r AS (SELECT *, row_number() OVER (PARTITION "
                "BY p ORDER BY n) AS i, {} OVER (PARTITION BY p ORDER BY n {}) AS w FROM t) SELECT "
                "1.0 * count(*) FROM r AS o WHERE w IS NOT (SELECT {} FROM (SELECT * FROM r AS a "
                "WHERE a.p = o.p AND {} ORDER BY a.i))",
                values, function, over, function, where));
        };
        CHECK(differing(frame, ends) == 0.0);
        CHECK(differing(frame + " EXCLUDE CURRENT ROW", ends + " AND a.i <> o.i") == 0.0);
        CHECK(differing("", "a.i <= o.i") == 0.0);
    }
}

TEST_CASE("information is log2 of what is distinguished, none where answers ignore the object") {
    Asked asked;
    const auto five =
        std::string("(VALUES ('a','a',7), ('b','b',7), ('c','c',7), ('d','d',7), ('e','e',7))");
    CHECK(asked.real("SELECT mutual_information(column1, column2, column3) FROM " + five) ==
          Approx(std::log2(5.0)).epsilon(1e-13));
    const std::string miller_madow =
        "SELECT mutual_information_miller_madow(column1, column2, column3) FROM ";
    // Perfect answers say what the object is and no more; of a guesser the correction leaves less
    // than nothing.
    CHECK(asked.real(miller_madow + five) == std::log2(5.0));
    const auto blind = std::string("(VALUES ('a','a',2), ('a','b',4), ('b','a',3), ('b','b',6))");
    CHECK(asked.real("SELECT mutual_information(column1, column2, column3) FROM " + blind) ==
          Approx(0.0).margin(1e-13));
    CHECK(asked.real(miller_madow + blind) == 0.0);
    // A binary channel with an error of 0.11: 1 - H(0.11) bits (T. M. Cover, J. A. Thomas, Elements
    // of Information Theory, 7.1.4).
    const auto channel = std::string("(VALUES (0,0,89), (0,1,11), (1,0,11), (1,1,89))");
    const double bits = 1.0 + 0.11 * std::log2(0.11) + 0.89 * std::log2(0.89);
    CHECK(asked.real("SELECT mutual_information(column1, column2, column3) FROM " + channel) ==
          Approx(bits).epsilon(1e-12));
    // 2 + 2 - 4 - 1 cells by 2 N ln 2.
    CHECK(asked.real(miller_madow + channel) ==
          Approx(bits - 1.0 / (2.0 * 200.0 * std::numbers::ln2)).epsilon(1e-12));
    // Categories are those of SQL's own equality: 1 = 1.0, and 1 is not '1'.
    CHECK(asked.real("SELECT mutual_information(column1, column2) FROM (VALUES (1,'a'), "
                     "(1.0,'a'), (2,'b'), (2.0,'b'))") == Approx(1.0).epsilon(1e-13));
    CHECK(asked.real("SELECT mutual_information(column1, column2) FROM (VALUES (1,'a'), ('1','b'), "
                     "(1.5,'c'), ('1.5','d'))") == Approx(2.0).epsilon(1e-13));
    // Rows are counts: one row a trial says the same.
    CHECK(asked.real("SELECT mutual_information(column1, column2) FROM (VALUES (0,0), (0,0), "
                     "(1,1), (1,0))") ==
          asked.real("SELECT mutual_information(column1, column2, column3) FROM (VALUES (0,0,2), "
                     "(1,1,1), (1,0,1))"));
}

TEST_CASE("a file without ticks' table has no samples, and says so") {
    NewDatabase database;
    database.execute("PRAGMA foreign_keys = OFF; DROP TABLE trace_chunk");
    REQUIRE(data::add_extension(database.handle()) == 0);
    const auto ask = [&] {
        return database.prepare("SELECT * FROM sample").step();
    };
    CHECK_THROWS_WITH(ask(), Has("trace_chunk"));
}
