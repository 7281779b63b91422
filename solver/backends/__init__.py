"""The solvers of linear and integer programs: SCIP, and HiGHS as an extra."""
