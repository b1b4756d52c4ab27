// Figure 2.1.2: the closest point as six trackers find it, HIP passing over a narrow top on a line.
#include "engine/contact/certified_tracker.hpp"
#include "tests/figures/drawing.hpp"
#include "tests/figures/make.hpp"
#include "tests/figures/thesis/curve_tracker.hpp"

namespace palpate::figures {
namespace {

using namespace palpate::engine;

constexpr Vec2 kFrom{-0.050, 0.038};  // m, HIP's line
constexpr Vec2 kTo{0.050, 0.062};     // m
constexpr double kSpeed = 0.3;        // m/s
constexpr double kLoopGain = 40.0;    // K max|f'|^2 T, over kSubSteps Euler steps
constexpr int kSubSteps = 40;
constexpr double kSettled = 0.05;  // s: what a tracker does before is its start
constexpr std::size_t kEvery = 4;  // ticks from one drawn connection to the next

struct Track {
    std::string name{};
    std::vector<Vec2> points{};  ///< tracked, m
    std::vector<double> u{};
    std::vector<double> error{};  ///< |tracked - closest|, m
};

struct Passage {
    std::vector<double> t;
    std::vector<Vec2> hip;
    std::vector<Track> tracks;  ///< five of the thesis, then the certified one
};

std::vector<Vec2> straight_line() {
    const double length = glm::length(kTo - kFrom);
    std::vector<Vec2> hip;
    for (double way = 0.0; way <= length; way += kSpeed * kTick) {
        hip.push_back(kFrom + (way / length) * (kTo - kFrom));
    }
    return hip;
}

Track thesis_track(const engine::NurbsCurve<2>& curve,
                   const TrackerSpec& spec,
                   const std::vector<Vec2>& hip) {
    const CurveTracker tracker(curve, spec);
    Track track{.name = std::string(to_string(spec.kind))};
    std::replace(track.name.begin(), track.name.end(), '_', ' ');
    TrackerState state = tracker.start(hip.front());
    for (const Vec2& h : hip) {
        const TrackedFoot foot = tracker.step(state, h, kTick);
        track.points.push_back(foot.point);
        track.u.push_back(foot.u);
    }
    return track;
}

Track certified_track(const Outline& outline, const std::vector<Vec2>& hip) {
    const engine::CertifiedTracker tracker(outline);
    Track track{.name = "certified"};
    engine::TrackState state;
    for (const Vec2& h : hip) {
        const engine::ClosestPoint cp = tracker.track(state, h);
        track.points.push_back(cp.point);
        track.u.push_back(engine::segment_place(outline, cp.place).u);
    }
    return track;
}

Passage pass_over(const engine::NurbsCurve<2>& curve) {
    const Outline outline({curve}, false);
    const engine::OutlineFeet feet(outline);
    Passage passage{.t = {}, .hip = straight_line(), .tracks = {}};
    const double gain = feedback_gain(curve, kLoopGain, kTick);
    const std::array<TrackerSpec, 5> specs{{
        {.kind = TrackerKind::feedback, .gain = gain, .sub_steps = kSubSteps},
        {.kind = TrackerKind::feed_forward, .gain = gain, .sub_steps = kSubSteps},
        {.kind = TrackerKind::feedback_linearised, .gain = 0.5 / kTick},
        {.kind = TrackerKind::tangent_plane, .rate_hz = 100.0},
        {.kind = TrackerKind::newton},
    }};
    for (const TrackerSpec& spec : specs) {
        passage.tracks.push_back(thesis_track(curve, spec, passage.hip));
    }
    passage.tracks.push_back(certified_track(outline, passage.hip));
    for (std::size_t i = 0; i < passage.hip.size(); ++i) {
        passage.t.push_back(static_cast<double>(i) * kTick);
        const Vec2 closest = feet.closest(passage.hip[i]).point;
        for (Track& track : passage.tracks) {
            track.error.push_back(glm::length(track.points[i] - closest));
        }
    }
    return passage;
}

Panel connections(const Passage& passage,
                  const Track& track,
                  const engine::NurbsCurve<2>& curve,
                  std::string title,
                  Ink ink) {
    Panel panel = plane_mm(std::move(title), 250.0);
    std::vector<Vec2> lines;
    for (std::size_t i = 0; i < passage.hip.size(); i += kEvery) {
        lines.insert(lines.end(), {passage.hip[i], track.points[i], gap()});
    }
    panel.series = {outline_mm({curve}), path_mm("HIP", passage.hip, {Ink::grey}),
                    path_mm("HIP to tracked point, every 4 ms", lines, {ink, 1.0})};
    look_at(panel, -24.0, 24.0, 27.0, 58.0);
    return panel;
}

/// What every tracker shows over time; the error is drawn from 1e-18 m up.
std::vector<Panel> over_time(const Passage& passage) {
    Panel place = time_panel("(c) Tracked point along the curve", "u", "", 240.0);
    place.y.low = 0.0;
    place.y.high = 1.0;
    Panel error{.title = "(d) Distance to the closest point",
                .x = {.label = "time", .unit = "s"},
                .y = {.label = "error", .unit = "m", .log = true, .low = 3e-18, .high = 3e-2},
                .height = 240.0};
    for (const Track& track : passage.tracks) {
        const bool last = &track == &passage.tracks.back();
        const Ink ink = last ? Ink::black : Ink::automatic;
        Series u{.name = track.name, .x = passage.t, .y = track.u, .ink = ink};
        u.stroke = last ? Stroke::dashed : Stroke::solid;
        place.series.push_back(u);
        Series e{.name = track.name, .x = passage.t, .y = track.error, .ink = ink};
        for (double& value : e.y) {
            value = std::max(value, 1e-17);
        }
        error.series.push_back(e);
    }
    return {place, error};
}

double worst(const Passage& passage, std::size_t track) {
    double max = 0.0;
    for (std::size_t i = 0; i < passage.t.size(); ++i) {
        max = passage.t[i] >= kSettled ? std::max(max, passage.tracks[track].error[i]) : max;
    }
    return max;
}

std::vector<CsvColumn> table(const Passage& passage) {
    std::vector<CsvColumn> columns{{"time_s", passage.t}};
    add_vectors(columns, "hip", "m", passage.hip, std::identity());
    for (const Track& track : passage.tracks) {
        std::string name = track.name;
        std::replace(name.begin(), name.end(), ' ', '_');
        columns.push_back({name + "_u", track.u});
        add_vectors(columns, name, "m", track.points, std::identity());
        columns.push_back({name + "_error_m", track.error});
    }
    return columns;
}

}  // namespace

MadeFigure make_trackers() {
    const Polygons object = narrow_arch();
    const engine::NurbsCurve<2> curve = curves_of(object).front();
    const Passage passage = pass_over(curve);
    Figure figure{.id = "fig_2_1_2",
                  .title = "Figure 2.1.2: trackers of the closest point over a narrow top",
                  .columns = 2,
                  .width = 980.0};
    figure.panels = {
        connections(passage, passage.tracks[0], curve, "(a) Feedback-stabilised", Ink::purple),
        connections(passage, passage.tracks[3], curve, "(b) Tangent plane, renewed at 100 Hz",
                    Ink::blue)};
    for (Panel& panel : over_time(passage)) {
        figure.panels.push_back(std::move(panel));
    }
    figure.caption = fmt::format(
        "HIP follows a straight line at {:g} m/s past a cubic whose top has a radius of 5.6 mm; "
        "ticks of 1 ms. Feedback and feed-forward take {} Euler steps a tick at a loop gain of "
        "{:g}; the linearised law has 500 1/s; Newton takes one step a tick. Largest error after "
        "the first {:g} s: feedback {:.2g} mm, feed-forward {:.2g} mm, linearised {:.2g} mm, "
        "tangent plane {:.2g} mm, Newton {:.2g} mm, certified {:.2g} mm. The connections of (a) "
        "stand on the curve, those of (b) end beside it where it turns fastest. Errors below "
        "1e-17 m are drawn there.",
        kSpeed, kSubSteps, kLoopGain, kSettled, 1e3 * worst(passage, 0), 1e3 * worst(passage, 1),
        1e3 * worst(passage, 2), 1e3 * worst(passage, 3), 1e3 * worst(passage, 4),
        1e3 * worst(passage, 5));
    return {svg(figure), {{"", table(passage)}, {"_object", control_point_table(object)}}};
}

}  // namespace palpate::figures
