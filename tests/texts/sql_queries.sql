SELECT tick, time_s, hip_x_m, hip_vy_m_per_s, rendered_normal_n, rendered_tangential_n, commanded_x_n, mu, flags, code_1 FROM sample WHERE trial_id = 3 AND tick % 97 = 0
SELECT trial_id, count(*), avg(rendered_normal_n), sum(mode = 'slip'), max(hip_vx_m_per_s) FROM sample GROUP BY trial_id
SELECT clopper_pearson_low(7, 20), wilson_high(7, 20), d_prime(7, 20, 5), probit(0.1), normal_cdf(1)
SELECT friction, median(path_length_m), stddev_samp(done_s), quantile(done_s, 0.9), share(correct) FROM analysis_trial GROUP BY friction
SELECT trial_id, quantile(done_s, 0.5) OVER w, geometric_mean(done_s) OVER w, stddev_samp(done_s) OVER w, share(correct) OVER w, mutual_information(planned_object, chosen_object) OVER w, people_mean_low(done_s) OVER w FROM analysis_trial WINDOW w AS (ORDER BY trial_id ROWS BETWEEN 3 PRECEDING AND 1 FOLLOWING)
