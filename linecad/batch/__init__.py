"""Many photos with one command: by processes or a cluster, with a record and a page to look at (docs/guide/batch.md).

A *job* is one photo to convert, an *outcome* what came of it, a *row* its line in the record. An executor works on
jobs: `local` in processes of this machine, `cluster` on a Dask cluster, whose machines use `local` in turn.
"""
