% The numbers of the MEX function: against the file of the reference, on the record of the examples; and what it refuses.
%   test_trendid(record.csv): prints a line per number, in hexadecimal, which `cargo xtask octave` compares with Rust.
function test_trendid(record)
  data = dlmread(record, ',', 6, 0);
  u = data(:, 2);
  y = data(:, 3);
  found = trendid_identify(0.001, u, y, 'u_range', 0.4, 'y_range', 50);
  numbers = [found.theta, found.std, found.covariance(:).', found.gain, found.omega0, found.damping, found.omega0_std];
  numbers = [numbers, found.innovation(~isnan(found.innovation)).'];
  printf('servo %s\n', sprintf('%08x', typecast(single(numbers), 'uint32')));
  full = trendid_identify(0.001, [u, [0; u(1:end - 1)]], y, 'order', 2, 'zeros', 0, 'constant', false, ...
                          'initial', false, 'u_range', [0.4, 0.4], 'y_range', 50, 'memory', 1, 'delay', [1.5, 2], 'hold', [0, 1], ...
                          'follow_changes', true);
  printf('two %s\n', sprintf('%08x', typecast(single([full.theta, full.std]), 'uint32')));

  % The truth of the record, and the shape of the results.
  truth = [400, 20, 1e6];
  assert(all(abs(found.theta(1:3) - truth) < 4 * found.std(1:3)));
  assert(isequal(size(found.covariance), [5, 5]) && isequal(size(found.b), [1, 3]) && found.stable);
  assert(isequal(found.den, [1, found.theta(2), found.theta(1), 0]) && found.num{1}(3) == found.theta(3));

  % Counts as integers are the numbers that they are.
  counts = round(1000 * y);
  same = trendid_identify(single(0.001), u, int32(counts), 'noise', 30, 'memory', 0.7);
  double_counts = trendid_identify(single(0.001), u, counts, 'noise', 30, 'memory', 0.7);
  assert(isequal(same.theta, double_counts.theta) && isequal(same.std, double_counts.std));

  refused(@() trendid_identify(0.001, u, y, 'bandwidth', 5000), 'bandwidth = 5000');
  refused(@() trendid_identify(0.001, u, y, 'order', 5), 'order = 5');
  refused(@() trendid_identify(0.001, u, y, 'ordre', 3), 'ordre');
  refused(@() trendid_identify(0.001, u(1:10), y), 'u has 10 samples');
  refused(@() trendid_identify(0.001, u, y, 'delay', 65), 'delay = 65');
  refused(@() trendid_identify(0.001, u, y, 'delay', -0.5), 'delay = -0.5');
  refused(@() trendid_identify(0.001, u, y, 'hold', 3), 'hold = 3');
  refused(@() trendid_identify(0.001, u, y, 'hold', 0.5), 'hold = 0.5');
  refused(@() trendid_identify(0.001, u, y, 'follow_changes', true), 'follow_changes = 1');
  refused(@() trendid_identify(NaN, u, y), 'sample_time');
  refused(@() trendid_identify(0.001, u, y, 'order', 4, 'zeros', 3), 'more parameters');
  refused(@() trendid_identify(0.001, u, y, 'noise', [], 'delay', [1, 2]), 'noise must be one real number');
  refused(@() trendid_identify(0.001, u, y, 'delay', [1, 2]), 'delay has 2 values, expected 1 or one per input');
  refused(@() trendid_identify(0.001, u, y, 'u_range', []), 'u_range has 0 values');
  refused(@() trendid_identify(0.001, u, y, 'integrator', 'false'), 'integrator must be one real number');
  refused(@() trendid_identify(0.001, u, y, 'constant', NaN), 'constant = NaN');
  refused(@() trendid_identify(0.001, u, y + 1i), 'y must be real numbers');
  refused(@() trendid_identify(0.001, u, {y}), 'y must be real numbers');
  refused(@() trendid_identify(0.001, [u, u], [y, y]), 'y has 4000 rows and 2 columns');
  refused(@() trendid_identify(data(:, 1), u, y), 'the sample time must be one real number');
  refused(@() trendid_identify(0.001, u), 'are needed');
  refused(@() trendid_mex(1), 'six arguments');
  printf('refusals ok\n');
end

function refused(call, part)
  try
    call();
  catch problem
    assert(~isempty(strfind(problem.message, part)), problem.message);
    return
  end
  error('nothing was refused: %s', part);
end
