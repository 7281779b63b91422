"""What a reader of a scene should know of the search that it comes from."""

from linecad.line_graph import Solution


def notes_on_solver(solution: Solution) -> list[str]:
    """One line where the answer is not proven to be the best; none where it is."""
    if solution.status == "optimal":
        return []
    if solution.status == "robust fit":
        return ["depths by a robust fit to all crossings, without a search: nothing is proven, the gap is unknown"]
    if solution.status == "heuristic":
        return [f"the time was over before the exact search began; the gap is {solution.gap:.1%}"]
    ended = "was interrupted" if solution.status == "interrupted" else f"reached its {solution.status}"
    return [f"the solver {ended} with a gap of {solution.gap:.1%}: not proven optimal"]
