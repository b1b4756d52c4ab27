g <- expand.grid(threshold = 1:9, sd = c(1, 2, 4, 8), lapse = c(0, .05))
w <- normal(g, function(g) 1 / g$sd, function(g) g$lapse, function(g) 1 - g$lapse)
say('threshold', g$threshold, w); say('JND', qnorm(.75) * g$sd, w); say('sd', g$sd, w); say('lapse', g$lapse, w)
