"""The fits of the page beside those of the command `fit`, for all measured samples."""

import json
import os
import pathlib
import re
import subprocess

import pytest
from conftest import ROOT

SAMPLES = sorted(path.stem for path in (ROOT / "data" / "measured").glob("*.csv"))


@pytest.fixture(scope="session")
def program():
    program = os.environ.get("BRDF_PROGRAM")
    if not program or not pathlib.Path(program).is_file():
        pytest.skip("no program brdf: expected BRDF_PROGRAM to be its path")
    return program


def leaves(value, path=""):
    """The values of a document, by their paths. Times differ from run to run."""
    if isinstance(value, dict):
        for key, part in value.items():
            if key != "seconds":
                yield from leaves(part, f"{path}.{key}")
    elif isinstance(value, list):
        for i, part in enumerate(value):
            yield from leaves(part, f"{path}[{i}]")
    else:
        yield path, value


def difference(a, b):
    """The relative difference of two numbers."""
    return 0.0 if a == b else abs(a - b) / max(abs(a), abs(b))


@pytest.mark.parametrize("sample", SAMPLES)
def test_the_fits_of_the_page_are_those_of_the_command(viewer, program, tmp_path, sample):
    tab = viewer(f"#sample={sample}")
    tab.until_status("fitted")
    page = json.loads(tab.download(lambda: tab.press("Control+s"), tmp_path).read_text())
    file = f"data/measured/{sample}.csv"
    native = tmp_path / "native.json"
    arguments = [program, "fit", file, "--n", "1.5", "--json", native]
    subprocess.run(arguments, cwd=ROOT, check=True, capture_output=True)
    page, native = (dict(leaves(document)) for document in (page, json.loads(native.read_text())))
    assert page.keys() == native.keys()
    differences = {}
    for path, value in native.items():
        if isinstance(value, float) and not isinstance(page[path], bool):
            differences[path] = difference(page[path], value)
        else:
            assert page[path] == value, path
    differing = {path: value for path, value in differences.items() if value > 0}
    largest = sorted(differing, key=differing.get)[-5:]
    print(f"{sample}: {len(differing)} of {len(differences)} numbers differ; by most: ",
          *(f"{path} {native[path]!r} {page[path]!r}" for path in largest), sep="\n  ")
    # What is printed has six digits at the most.
    assert [path for path in differing if f"{page[path]:.6g}" != f"{native[path]:.6g}"] == []
    # The parameters and E themselves are equal to the last bit.
    assert [path for path in differing if re.match(r"\.reports\[\d+\]\.fit\.(parameters|e_percent)", path)] == []
