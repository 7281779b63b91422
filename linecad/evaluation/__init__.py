"""How good a reconstruction is: truth of several kinds, the paper's tables, depths, planes, a report."""
