"""The commands of `wayline evaluate`."""

import typer

from wayline_evaluation.commands.arrivals import arrivals_app
from wayline_evaluation.commands.coupling import coupling_app
from wayline_evaluation.commands.positions import positions_app
from wayline_evaluation.commands.slopes import slopes_app

evaluate_app = typer.Typer(
    help="Studies of how good estimates are, on any drives.", no_args_is_help=True
)
for app in (positions_app, arrivals_app, coupling_app, slopes_app):
    evaluate_app.add_typer(app)
