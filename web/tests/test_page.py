"""What the page does."""

import json

import pytest
from conftest import ROOT

MEASURED = ROOT / "data" / "measured"
Z307 = MEASURED / "z307_on_aluminium.csv"
TITANIUM = MEASURED / "titanium_anodise.csv"
# The third of the parameters k2, kD, k1, n.
K1 = 2


def test_the_page_says_that_it_loads_and_shows_a_sample_that_is_fitted(viewer, address, browser):
    raw = browser.new_page()
    raw.route("**/*.wasm", lambda route: route.abort())
    raw.goto(address, wait_until="commit")
    raw.locator("#message", has_text="cannot be loaded").wait_for()
    raw.close()
    page = browser.new_page()
    page.route("**/viewer.js", lambda route: None)
    page.goto(address, wait_until="commit")
    text = page.locator("#message").text_content()
    assert "Loading" in text and "never" in text
    page.close()
    tab = viewer()
    tab.until_status("fitted")
    assert tab.message() is None
    assert tab.attribute("errors") == "" and tab.complaints == []
    tab.picture("1-loaded")


def test_a_scan_is_dropped_turned_fitted_cancelled_and_fitted_again(viewer, tmp_path):
    tab = viewer()
    tab.until_status("fitted")
    tab.drop(TITANIUM)
    tab.place("show titanium_anodise")
    tab.until_status("fitted")
    tab.picture("2-dropped")
    before = tab.parameter("SpinButton", K1)["value"]
    left, top, right, bottom = tab.parameter("Slider", K1)["bounds"]
    y = (top + bottom) / 2
    tab.drag((left + 0.3 * (right - left), y), (left + 0.7 * (right - left), y))
    assert tab.parameter("SpinButton", K1)["value"] != before
    tab.picture("3-slider")
    tab.press("F5")
    tab.until_status("fitted")
    assert tab.parameter("SpinButton", K1)["value"] == before
    # A fit that takes long enough to be cancelled.
    lines = TITANIUM.read_text().splitlines()
    readings = [line for line in lines if line[:1].isdigit()]
    long = tmp_path / "long.csv"
    long.write_text("\n".join(lines + 300 * readings))
    tab.choose(long)
    tab.place("show long")
    tab.until("a fit that runs", lambda: tab.attribute("busy") == "true")
    tab.press("Escape")
    tab.until_status("cancelled")
    tab.press("F5")
    tab.until_status("fitted")
    assert tab.attribute("errors") == "" and tab.complaints == []


def test_figures_tables_and_fits_are_downloads(viewer, tmp_path):
    tab = viewer()
    tab.until_status("fitted")
    for keys, ending, beginning in [
        ("Control+e", ".svg", b"<svg"),
        ("Control+Shift+E", ".png", b"\x89PNG"),
        ("Control+Shift+S", ".csv", b"file,"),
        ("Control+s", ".json", b"{"),
    ]:
        file = tab.download(lambda keys=keys: tab.press(keys), tmp_path)
        content = file.read_bytes()
        assert (file.suffix, content[: len(beginning)]) == (ending, beginning)
    tab.click("File")
    assert not tab.places("Quit") and not tab.places("Open path...")
    tab.picture("4-menu")
    file = tab.download(lambda: tab.click(tab.entry("Save fit as JSON...")), tmp_path)
    assert json.loads(file.read_text())["reports"][0]["fit"]


def test_a_fit_and_its_scan_are_chosen_together(viewer, tmp_path):
    tab = viewer("#sample=titanium_anodise")
    tab.until_status("fitted")
    fit = tab.download(lambda: tab.press("Control+s"), tmp_path)
    document = fit.read_text().replace("data/measured/titanium_anodise.csv", "elsewhere/own.csv")
    fit.write_text(document)
    scan = tmp_path / "own.csv"
    scan.write_bytes(TITANIUM.read_bytes())
    tab = viewer()
    tab.until_status("fitted")
    tab.drop(fit)
    tab.until("an error", lambda: "together with the fit" in tab.attribute("errors"))
    tab.choose(fit, scan)
    tab.until("two samples", lambda: tab.places("show own"))
    assert not tab.places("show own (2)")


def test_settings_and_session_are_kept_with_the_scans(viewer, tmp_path):
    own = tmp_path / "own.csv"
    own.write_bytes(Z307.read_bytes())
    tab = viewer()
    tab.until_status("fitted")
    tab.drop(own)
    tab.place("show own")
    tab.until_status("fitted")
    tab.click("log")
    tab.press("F9")
    tab.until("saved settings", lambda: "own.csv" in saved(tab) and '"dark": true' in saved(tab))
    before = saved(tab)
    again = viewer(context=tab.page.context)
    again.until_status("fitted")
    assert again.place("show own") and again.place("show z307_on_aluminium")
    assert again.attribute("errors") == ""
    again.picture("5-session")
    before, after = json.loads(before), json.loads(saved(again))
    assert (after["view"], after["interface"]) == (before["view"], before["interface"])
    assert "brdf-viewer/file/own.csv" in again.page.evaluate("Object.keys(localStorage)")


def saved(tab):
    return tab.page.evaluate("localStorage['brdf-viewer/settings']")


def test_what_is_too_large_to_be_kept_is_said(viewer, tmp_path):
    large = tmp_path / "large.csv"
    lines = Z307.read_text().splitlines()
    large.write_text("\n".join(["#" + "x" * 1000] * 4100 + lines))
    tab = viewer()
    tab.until_status("fitted")
    tab.choose(large)
    tab.until("a note", lambda: any("too large" in place for place in names(tab)))
    assert "large.csv" in saved(tab)
    larger = tmp_path / "larger.csv"
    larger.write_bytes(b"#" + b"x" * (17 << 20) + b"\n" + Z307.read_bytes())
    tab.choose(larger)
    tab.until("an error", lambda: "at most 16 MB" in tab.attribute("errors"))


def names(tab):
    places = json.loads(tab.attribute("places") or "[]")
    return [place["name"] + place["value"] for place in places]


def test_a_link_opens_a_sample(viewer):
    tab = viewer("#sample=black_anodise_on_aluminium")
    tab.until_status("fitted")
    assert tab.places("show black_anodise_on_aluminium") and not tab.places("show z307_on_aluminium")
    unknown = viewer("#sample=nothing")
    unknown.until_status("fitted")
    assert "expected one of z307_on_aluminium," in unknown.attribute("errors")


@pytest.mark.parametrize("sample", ["z307_on_aluminium"])
def test_a_telephone_shows_plot_and_parameters(viewer, sample):
    tab = viewer(f"#sample={sample}", width=390, height=844, device_scale_factor=1, has_touch=True, is_mobile=True)
    tab.until_status("fitted")
    tab.picture("6-telephone")
    assert tab.page.evaluate("document.documentElement.scrollWidth") == 390
    for place in [tab.parameter("Slider", K1), tab.place("File"), tab.place("parameters")]:
        left, top, right, bottom = place["bounds"]
        assert 0 <= left < right <= 390 and 0 <= top < bottom <= 844, place
    tab.frames()
    tab.page.touchscreen.tap(*tab.middle("parameters"))
    tab.until("a hidden panel", lambda: not tab.places("fit both stages"))
    tab.picture("7-telephone-plot")


def test_the_page_says_when_it_cannot_go_on(viewer):
    tab = viewer()
    tab.until_status("fitted")
    tab.page.evaluate("document.getElementById('viewer').getContext('webgl2').getExtension('WEBGL_lose_context').loseContext()")
    tab.until("a message", lambda: "graphics" in (tab.message() or ""))
    tab.picture("8-lost")


def test_a_panic_is_said(browser, address):
    page = browser.new_page()
    page.goto(f"{address}?panic")
    page.wait_for_function("document.getElementById('message').textContent.includes('internal error')")
    assert "kept" in page.locator("#message").text_content()
    page.close()


def test_fits_follow_each_other_and_their_long_tasks_are_told(viewer):
    tab = viewer()
    tab.until_status("fitted")
    tab.press("F5")
    tab.until_status("fitted")
    tab.frames(5)
    tab.long_tasks()
    # Drawing without a graphics card takes long as well: what a frame takes anyway is no matter of the fit.
    for at in range(10):
        tab.page.mouse.move(400 + 10 * at, 300)
        tab.frames(1)
    drawing = tab.long_tasks()
    fitting = []
    for _ in range(3):
        tab.press("F5")
        tab.until_status("fitted")
        fitting += tab.long_tasks()
    print(f"long tasks of the page in ms: while drawing {drawing}, while fitting {fitting}")
