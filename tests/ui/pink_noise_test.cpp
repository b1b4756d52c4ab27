#include <unsupported/Eigen/FFT>

#include "ui/sound/faded_noise.hpp"
#include "tests/support/catch.hpp"

using namespace palpate::ui;

namespace {

constexpr Eigen::Index kPiece = 32768;
constexpr int kPieces = 48;  // the 50 Hz third has a standard deviation of about 0.27 dB then

/// log2 of the middles of thirds of octaves, 49.6 Hz to 10.08 kHz, over 1 kHz.
const Eigen::ArrayXd kOctaves = Eigen::ArrayXd::LinSpaced(24, -13.0 / 3.0, 10.0 / 3.0);

/// Mean power of each bin over so many pieces (Welch 1967, Hann's window, no overlap).
template <class Next>
Eigen::ArrayXd spectrum(Next&& next, int pieces) {
    Eigen::FFT<double> fourier;
    Eigen::ArrayXd power = Eigen::ArrayXd::Zero(kPiece / 2);
    Eigen::VectorXd piece(kPiece);
    Eigen::VectorXcd bins;
    for (int p = 0; p < pieces; ++p) {
        for (Eigen::Index i = 0; i < kPiece; ++i) {
            piece[i] =
                (0.5 - 0.5 * std::cos(2.0 * M_PI * static_cast<double>(i) / kPiece)) * next();
        }
        fourier.fwd(bins, piece);
        power += bins.head(kPiece / 2).array().abs2();
    }
    return power;
}

/// dB of the power per hertz against 1/f in each third, their mean made 0: all 0 for pink noise.
Eigen::ArrayXd thirds(const Eigen::ArrayXd& power, double rate) {
    Eigen::ArrayXd levels(kOctaves.size());
    for (Eigen::Index third = 0; third < levels.size(); ++third) {
        const double middle = 1000.0 * std::exp2(kOctaves[third]);
        double found = 0.0;
        double pink = 0.0;
        for (Eigen::Index k = 1; k < power.size(); ++k) {
            const double f = rate / kPiece * static_cast<double>(k);
            if (f >= middle * std::exp2(-1.0 / 6.0) && f < middle * std::exp2(1.0 / 6.0)) {
                found += power[k];
                pink += 1.0 / f;
            }
        }
        levels[third] = 10.0 * std::log10(found / pink);
    }
    return levels - levels.mean();
}

/// dB an octave by least squares, 0 for pink noise.
double tilt(const Eigen::ArrayXd& levels) {
    const Eigen::ArrayXd x = kOctaves - kOctaves.mean();
    return (x * levels).sum() / x.square().sum();
}

}  // namespace

TEST_CASE("pink noise loses 3 dB an octave within 1 dB from 50 Hz to 10 kHz, at every rate") {
    EACH(rate, 44100.0, 48000.0, 96000.0);
    PinkNoise noise(Pcg32(20260114, 7), rate);
    const Eigen::ArrayXd levels = thirds(spectrum([&] { return noise.next(); }, kPieces), rate);
    for (Eigen::Index third = 0; third < levels.size(); ++third) {
        CAPTURE(1000.0 * std::exp2(kOctaves[third]), levels[third]);
        CHECK(std::fabs(levels[third]) <= 1.0);
    }
    CHECK(std::fabs(tilt(levels)) <= 0.06);
}

TEST_CASE("the spectrum test tells pink noise from white and from brown") {
    Pcg32 random(1, 2);
    const auto white = [&] {
        return static_cast<double>(random.next()) / 2147483648.0 - 1.0;
    };
    CHECK(tilt(thirds(spectrum(white, 8), 48000.0)) > 2.8);
    double sum = 0.0;
    const auto brown = [&] {
        return sum = 0.9999 * sum + white();
    };
    CHECK(tilt(thirds(spectrum(brown, 8), 48000.0)) < -2.5);
}

TEST_CASE("pink noise has mean square 1 and nearly Gaussian peaks, one seed one noise") {
    SEED(3ULL);
    PinkNoise noise(Pcg32(seed, 3), 48000.0);
    PinkNoise same(Pcg32(seed, 3), 48000.0);
    PinkNoise other(Pcg32(seed + 100, 3), 48000.0);
    constexpr int kSamples = 40 * 48000;
    double square = 0.0;
    double product = 0.0;
    int beyond = 0;
    bool equal = true;
    for (int i = 0; i < kSamples; ++i) {
        const double x = noise.next();
        equal = equal && x == same.next();
        square += x * x;
        product += x * other.next();
        beyond += std::fabs(x) > 4.0 ? 1 : 0;
    }
    CHECK(equal);
    CHECK(std::fabs(square / kSamples - 1.0) < 0.06);
    CHECK(std::fabs(product / kSamples) < 0.06);
    CHECK(beyond < kSamples / 8000);  // Gauss: 1 in 15787
}

TEST_CASE("noise comes in and goes out along t^2 (3 - 2 t) and is silent before and after") {
    constexpr double kRate = 48000.0;
    const double level = GENERATE(-60.0, -30.0, -12.0);
    FadedNoise faded(Pcg32(5, 9), kRate, level);
    PinkNoise plain(Pcg32(5, 9), kRate);
    const double amplitude = std::pow(10.0, level / 20.0);
    std::vector<float> block(480);
    double t = 0.0;  // of the fade, by hand
    double worst = 0.0;
    const auto run = [&](int blocks, double direction) {
        for (int i = 0; i < blocks; ++i) {
            faded.render(block);
            for (const float sample : block) {
                t = std::clamp(t + direction / (0.25 * kRate), 0.0, 1.0);
                const double wanted = amplitude * t * t * (3.0 - 2.0 * t) * plain.next();
                worst = std::max(
                    worst, std::fabs(static_cast<double>(sample) - std::clamp(wanted, -1.0, 1.0)));
            }
        }
    };
    run(10, -1.0);
    CHECK((faded.silent() && !faded.full()));
    CHECK(std::all_of(block.begin(), block.end(), [](float x) { return x == 0.0F; }));
    faded.on();
    run(24, 1.0);
    CHECK((!faded.full() && !faded.silent()));
    run(2, 1.0);
    CHECK(faded.full());
    run(100, 1.0);
    CHECK(faded.full_s() == Approx(1.01).margin(0.011));
    faded.off();
    run(26, -1.0);
    CHECK(faded.silent());
    CHECK(std::all_of(block.begin(), block.end(), [](float x) { return x == 0.0F; }));
    CHECK(worst < 1e-7);
}

TEST_CASE("noise is as loud as its level says and never beyond full scale") {
    const double level = GENERATE(-60.0, -30.0, -12.0, 0.0);
    FadedNoise faded(Pcg32(11, 4), 48000.0, level);
    faded.on();
    std::vector<float> block(48000);
    faded.render(block);
    double square = 0.0;
    bool inside = true;
    constexpr int kSeconds = 20;
    for (int s = 0; s < kSeconds; ++s) {
        faded.render(block);
        for (const float x : block) {
            square += static_cast<double>(x) * static_cast<double>(x);
            inside = inside && std::fabs(x) <= 1.0F;
        }
    }
    CHECK(inside);
    if (level <= -12.0) {
        CHECK(std::fabs(10.0 * std::log10(square / (kSeconds * 48000.0)) - level) < 0.4);
    }
}

TEST_CASE("noise at a rate that no sound device has is refused") {
    for (const double rate : {0.0, 15999.0, 192001.0, std::nan("")}) {
        CHECK_THROWS_AS(PinkNoise(Pcg32(1, 1), rate), std::invalid_argument);
    }
}
