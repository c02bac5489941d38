"""Mutations that survive, and why: no test can notice them, or none that is run here.

waxstudy/results/kpis.py
    `on[:-1] * ~on[1:]` for `on[:-1] & ~on[1:]`: the same for booleans.
plugins/waxstudy_paper/actuators.py
    Another start of `last_on_s` or `fall` in `VariableTimesState`: both are set before they are read.
waxstudy/simulation/kernel.py
    `<=` for `<` at the limits of the room's temperatures: a sum of floats is not exactly on a limit.
    `_call_address` without its decorator: tests of compiled loops are too slow here.
waxstudy/identification/times.py
    `times[:, 0]` or `times[:, 2]` for `times[:, 1]` where a cycle does not move: none is known there.
    `*` for and, `+` for or, in `_lost`: the same for booleans.
    `off_after != len(off)` for `<`: no place in a sorted list is beyond its end.
waxstudy/identification/valve.py
    Another `maxiter`: no search here takes so many steps.
waxstudy/simulation/shift.py
    `!=` for `< LIMIT_K` in `_bracket`: no step goes beyond the limit.
    `/` for `*` of two residuals in `_bracket`: only the sign counts.
    `<` for `<= 0.0` in `_bracket`, `<=` for `< 0.0` in `solve`: a residual of 0 ends the search either way.
waxstudy/diagnosis/criteria.py
    `<=` for `== "actuator"`: it is the first stage by name.
    `found[-1]` for `found[0]` in `limit`: all compare the same way.
waxstudy/diagnosis/select/weigh.py
    `>=` for `== "s"` of a unit: all others come before it by name.
    Another number below 0 for what a motor may stray elsewhere: only above 0 it is asked.
waxstudy/diagnosis/residuals/continuous.py
    `<` for `<= RESTS`: a difference of two samples is not exactly on a limit.
    Another `prepend` or first `stretch`: the first sample is never judged.
"""
