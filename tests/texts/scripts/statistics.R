p <- function(d, m) integrate(function(x) dnorm(x - d) * pnorm(x)^(m - 1), -Inf, Inf, rel.tol = 1e-11)$value
cat('h\n'); cat(sprintf('%.15g', c(binom.test(13, 47)$conf.int, qnorm(0.123), uniroot(function(d) p(d, 5) - 31/50, c(0, 5), tol = 1e-12)$root, quantile(c(3, 1, 4, 1, 5, 9, 2.5), 0.3), sd(c(3, 1, 4, 1, 5)))), sep = ',')
